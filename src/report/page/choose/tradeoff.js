// What an objective costs in another, along the front: rates between a design and its neighbours.
//
// A neighbour of a design is worse in one objective only. Along an objective it counts within a tenth of its range on the front, or at the next
// value that the front has there. A little more of an objective costs the least that a neighbour asks for in proportion, and a little less of
// it brings the most: both rates are those of designs that are there, not of a surface laid through them.
{
  const LOCAL = 0.1;
  const EQUAL = 1e-9; // of the range: what differs by less is rounding

  // By how much an objective of another design is better than of this one; negative where it is worse.
  const gain = ({ column, goal }, row, other) => {
    const by = (goal === "max" ? 1 : -1) * (column.values[other] - column.values[row]);
    return Math.abs(by) <= EQUAL * (column.high - column.low) ? 0 : by;
  };

  // How far along an objective a neighbour may be, on its better and on its worse side.
  const reaches = (goals, row, rows) =>
    goals.map((goal) => {
      let [better, worse] = [Infinity, Infinity];
      for (let other = 0; other < rows; other++) {
        const by = gain(goal, row, other);
        if (by > 0 && by < better) better = by;
        if (by < 0 && -by < worse) worse = -by;
      }
      const usual = LOCAL * (goal.column.high - goal.column.low);
      return { better: Math.max(usual, better), worse: Math.max(usual, worse) };
    });

  // rates[a][b]: { cost: of b for each unit by which a gets better, gain: of b for each unit by which a gets worse }, each
  // { rate, row } of the neighbour that says so, or null.
  page.tradeoffs = (row) => {
    const goals = page.goals();
    const { rows } = page.front;
    const rates = goals.map(() => goals.map(() => ({ cost: null, gain: null })));
    const local = reaches(goals, row, rows);
    const within = (by, end) => by <= end * (1 + 1e-12);
    for (let other = 0; other < rows; other++) {
      const by = goals.map((goal) => gain(goal, row, other));
      const worse = by.reduce((count, it) => count + (it >= 0 ? 0 : 1), 0);
      if (worse !== 1) continue;
      const b = by.findIndex((it) => !(it >= 0));
      by.forEach((better, a) => {
        if (!(better > 0 && by[b] < 0)) return;
        const { cost } = rates[a][b];
        if (within(better, local[a].better) && !(cost && cost.rate <= -by[b] / better)) rates[a][b].cost = { rate: -by[b] / better, row: other };
        const { gain: brings } = rates[b][a];
        if (within(-by[b], local[b].worse) && !(brings && brings.rate >= better / -by[b])) rates[b][a].gain = { rate: better / -by[b], row: other };
      });
    }
    return { goals, rates };
  };

  // A small step of an objective: one of what is counted, 1 % of the value, or of the range where values come near 0 or hardly differ.
  page.smallStep = ({ column }, row) => {
    if (column.whole) return { step: 1, of: "" };
    const [least, most] = [Math.min(Math.abs(column.low), Math.abs(column.high)), Math.max(Math.abs(column.low), Math.abs(column.high))];
    if (column.low * column.high > 0 && least >= LOCAL * most && 0.02 * most <= column.high - column.low) return { step: Math.abs(column.values[row]) / 100, of: "1 %" };
    return { step: (column.high - column.low) / 100, of: "1 % of its range" };
  };

  const withUnit = (value, column) => `${page.short(value)}${column.unit ? ` ${page.unit(column.unit)}` : ""}`;

  // What a neighbour differs by, in words.
  const seenAt = (goals, row, other) => {
    const parts = goals.map(({ name, column }) => [name, column.values[other] - column.values[row], column]).filter(([, by]) => by !== 0);
    return `seen at design ${page.designOf(other)}: ${parts.map(([name, by, column]) => `${name} ${by > 0 ? "+" : ""}${withUnit(by, column)}`).join(", ")}`;
  };

  // The section of a card.
  page.tradeoffSection = (row) => {
    if (!page.front.objectives.length || page.goals().length < 2 || page.front.rows < 2) return null;
    const { goals, rates } = page.tradeoffs(row);
    const none = page.element("td", { class: "number muted", title: "the front has no neighbour there" }, "–");
    const cell = (a, b, key, step) => {
      if (a === b) return page.element("td", {});
      const found = rates[a][b][key];
      if (!found) return none.cloneNode(true);
      const { column, goal } = goals[b];
      const change = ((key === "gain") === (goal === "max") ? 1 : -1) * found.rate * step;
      return page.element("td", { class: "number", title: seenAt(goals, row, found.row), "data-trade": `${key} ${goals[a].name} ${column.name}`, "data-rate": String(found.rate), "data-by": page.designOf(found.row) }, `${change > 0 ? "+" : ""}${page.short(change)}`);
    };
    const line = (a, key) => {
      const { step } = page.smallStep(goals[a], row);
      const more = (key === "cost") === (goals[a].goal === "max");
      return page.element("tr", {}, page.element("th", { scope: "row" }, `${more ? "more" : "less"} ${key === "cost" ? "costs" : "brings"}`), goals.map((_, b) => cell(a, b, key, step)));
    };
    const title = (goal) => {
      const { step, of } = page.smallStep(goal, row);
      return page.element("tr", { class: "group" }, page.element("th", { colspan: goals.length + 1, scope: "rowgroup", title: goal.column.doc }, page.breakable(goal.name), page.element("span", { class: "unit" }, ` by ${withUnit(step, goal.column)}${of ? `, ${of}` : ""}`)));
    };
    const bodies = goals.map((goal, a) => page.element("tbody", {}, title(goal), line(a, "cost"), line(a, "gain")));
    const head = page.element("tr", {}, page.element("th", { scope: "col" }, "step"), goals.map(({ column }) => page.element("th", { scope: "col", class: "number" }, page.breakable(column.name), column.unit ? page.element("span", { class: "unit" }, page.unit(column.unit)) : null)));
    const missing = rates.some((of, a) => of.some(({ cost, gain }, b) => a !== b && !(cost && gain)));
    return page.element(
      "section",
      { id: "tradeoffs", "data-testid": "tradeoffs" },
      page.element("h3", {}, "Trade-offs along the front"),
      page.element("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "Trade-offs along the front" }, page.element("table", { class: "tradeoffs" }, page.element("thead", {}, head), bodies)),
      page.element("p", { class: "hint" }, `By designs of the front that are worse in one objective only and not further away than a tenth of the range, or than the next value: the least that a step costs and the most that it brings, in proportion.${missing ? " –: the front has no such neighbour." : ""}`),
    );
  };
}
