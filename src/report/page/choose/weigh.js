// The section of weights and wished values: a slider and a field for each objective, the first designs by them, and how stable their places are.
{
  const KINDS = { near: "each weight within ± 20 %", any: "any weights at all" };
  let kind = "near";
  let controls = []; // { sync }
  let run = 0;
  let wasWeighed = false;

  const number = (value, column) => page.element("td", { class: "number", title: page.full(value, column.type) }, page.short(value));

  const line = (goal) => {
    const { name, column } = goal;
    const unit = page.unit(column.unit);
    const slider = page.element("input", { type: "range", min: 0, max: 100, step: 1, "data-weight": name, "aria-label": `weight of ${name}`, input: () => page.setWeight(name, Number(slider.value)) });
    const share = page.element("output", { class: "number" });
    const field = page.element("input", { type: "number", step: "any", class: "bound", "data-wish": name, "aria-label": `wished value of ${name}${unit ? `, in ${unit}` : ""}` });
    field.addEventListener("change", () => {
      const value = field.value.trim() === "" ? NaN : Number(field.value);
      page.setWish(name, Number.isFinite(value) ? value : null);
    });
    const best = page.element("td", { class: "number" });
    controls.push({
      sync: (at) => {
        slider.value = page.weightOf(name);
        share.textContent = `${(100 * page.shares()[at]).toFixed(0)} %`;
        slider.setAttribute("aria-valuetext", `${share.textContent} of all weights`);
        if (field !== document.activeElement) field.value = page.wishOf(name) ?? "";
        const { low, high } = page.front.byName.get(name);
        field.placeholder = page.short(goal.goal === "max" ? high : low).replace("−", "-").replace(/\u202f/g, "");
        best.textContent = page.short(goal.goal === "max" ? high : low);
      },
    });
    return page.element("tr", {}, page.element("th", { scope: "row", title: column.doc }, page.breakable(name), page.element("span", { class: "unit" }, ` ${goal.goal}`)), page.element("td", { class: "weight" }, slider, " ", share), page.element("td", { class: "weight" }, field, unit ? page.element("span", { class: "unit" }, ` ${unit}`) : null), best);
  };

  // What the section is built for: other goals, or a first design after none, ask for another.
  const keyOf = () => `${page.front.rows > 0} ${page.goals().map(({ name, goal }) => `${name} ${goal}`).join()}`;

  const build = () => {
    const section = page.byId("weigh");
    const goals = page.goals();
    section.hidden = goals.length < 2 || !page.front.rows;
    section.dataset.goals = keyOf();
    controls = [];
    if (section.hidden) return section.replaceChildren();
    const head = [["objective", ""], ["weight", ""], ["wished value", ""], ["best on the front", "number"]].map(([text, style]) => page.element("th", { scope: "col", class: style }, text));
    const select = page.element("select", { id: "near", change: () => ((kind = select.value), page.events.call("choice")) }, Object.entries(KINDS).map(([value, text]) => page.element("option", { value, selected: value === kind }, text)));
    section.replaceChildren(
      page.element(
        "details",
        { open: page.isWeighed(), toggle: () => page.isWeighed() || page.schedule("weigh", update) },
        page.element("summary", {}, page.element("h2", { id: "weigh-title" }, "Weights and wished values")),
        page.element("p", { class: "hint" }, "For each objective it counts how far a design is from the best value on the front: 0 at the best, 1 at the worst. With a wished value it counts from there, and what is better than wished counts below 0. Each of these numbers is multiplied by the objective’s weight, and the largest product is the design’s score. The least score comes first: the design whose worst objective is least bad (weighted Chebyshev distance). A thousandth of the sum of the numbers decides between equals."),
        page.element("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "Weights by objective" }, page.element("table", { class: "weights" }, page.element("thead", {}, page.element("tr", {}, head)), page.element("tbody", {}, goals.map(line)))),
        page.element("div", { class: "controls no-print" }, page.element("label", {}, "Places tried with ", select), page.element("button", { type: "button", id: "clear-weights", "data-testid": "clear-weights", click: page.clearWeights }, "Equal weights, no wishes")),
        page.element("div", { id: "ranked", "data-testid": "ranked" }),
      ),
    );
    return null;
  };

  const wordsOf = (stable, shown) => {
    if (!stable) return "counting how often each design comes first …";
    const others = [...stable.wins].filter(([row]) => !shown.includes(row));
    const theirs = d3.sum(others, ([, wins]) => wins);
    const rest = others.length ? ` ${page.count(others.length)} other design${others.length > 1 ? "s come" : " comes"} first in the remaining ${page.percent(theirs, stable.sets)}.` : "";
    const tried = kind === "near" ? "in which each weight is multiplied by its own factor from 0.8 to 1.2" : "spread evenly over all weights that there are, whatever the sliders say";
    return `“Comes first”: in so many of ${page.count(stable.sets)} sets of weights, ${tried} (seed ${stable.seed}).${rest}`;
  };

  const table = (rows, stable) => {
    const goals = page.goals();
    const { scores } = page.ranking();
    const head = [page.element("th", { scope: "col", class: "number" }, "place"), page.element("th", { scope: "col" }, "design"), goals.map(({ column }) => page.element("th", { scope: "col", class: "number" }, page.breakable(column.name), page.element("span", { class: "unit" }, page.unit(column.unit)))), page.element("th", { scope: "col", class: "number" }, "score"), page.element("th", { scope: "col", class: "number" }, "comes first")];
    const first = (row) => (stable ? page.percent(stable.wins.get(row) || 0, stable.sets) : "…");
    const place = (at) => (at < page.ranking().order.length ? at + 1 : "–");
    const body = rows.map((row, at) =>
      page.element(
        "tr",
        { "data-row": row, class: at === 0 && page.isWeighed() ? "is-knee" : "", pointerenter: () => page.setCurrent(row), pointerleave: () => page.setCurrent(null) },
        page.element("td", { class: "number" }, place(at)),
        page.element("td", {}, page.element("button", { type: "button", class: "pin-name", title: "Open its card", click: () => page.openCard(row) }, page.full(page.designOf(row))), page.letterOf(row) ? page.element("span", { class: "pin-letter" }, page.letterOf(row)) : null),
        goals.map(({ column }) => number(column.values[row], column)),
        page.element("td", { class: "number" }, page.short(scores[row])),
        page.element("td", { class: "number", "data-wins": stable ? stable.wins.get(row) || 0 : null }, first(row)),
      ),
    );
    return page.element("div", { class: "scroll", role: "region", "aria-label": "The first designs" }, page.element("table", { class: "ranked" }, page.element("thead", {}, page.element("tr", {}, head)), page.element("tbody", {}, body)));
  };

  const wished = () => {
    const { reached, front } = page.ranking();
    if (!page.goals().some(({ name }) => page.wishOf(name) !== undefined)) return "";
    return reached ? `${page.count(reached)} of ${page.count(front.rows)} designs on the front reach${reached === 1 ? "es" : ""} every wished value. ` : "No design on the front reaches every wished value. ";
  };

  let known = { front: null, stable: null }; // what was counted of the sets of weights, and for which front
  const show = (stable) => {
    const box = page.byId("ranked");
    if (!box) return;
    known = { front: page.front, stable };
    const { front } = page;
    const part = front.of > front.rows ? `Of the ${page.count(front.rows)} designs that are shown. ` : "";
    const { order } = page.ranking();
    // Who is not among the first by these weights, but comes first with many others.
    const often = stable ? [...stable.wins].filter(([row]) => !order.includes(row)).sort((a, b) => b[1] - a[1]).slice(0, 3).map(([row]) => row) : [];
    const rows = [...order, ...often];
    const focused = box.contains(document.activeElement) ? document.activeElement.textContent : null;
    box.replaceChildren(page.isWeighed() ? "" : plain("By this score they come in this order:"), table(rows, stable), page.element("p", { class: "hint" }, `${part}${wished()}${wordsOf(stable, rows)}`));
    page.oneStop(box, ".pin-name", { isColumn: true });
    if (focused) [...box.querySelectorAll("button")].find((button) => button.textContent === focused)?.focus();
    box.dataset.done = stable ? "yes" : "no";
  };

  const plain = (more) => {
    const { front } = page;
    const knee = front.knee === null || front.knee === undefined ? "" : ` The knee, design ${page.designOf(front.knee)}, stands for that: of all designs it is nearest to the ideal, each objective scaled to its range on the front.`;
    return page.element("p", {}, `All weights are equal and nothing is wished.${knee} Move a weight, or type a value that you wish for. ${more}`);
  };

  let waiting = 0;
  const update = () => {
    if (page.byId("weigh").dataset.goals !== keyOf()) build();
    if (!controls.length || !page.front.rows) return null;
    controls.forEach(({ sync }, at) => sync(at));
    page.byId("near").value = kind;
    page.byId("clear-weights").disabled = !page.isWeighed();
    const mine = ++run;
    clearTimeout(waiting);
    const isWeighed = page.isWeighed();
    const details = page.byId("weigh").querySelector("details");
    // Somebody may close it again.
    if (isWeighed && !wasWeighed) details.open = true;
    wasWeighed = isWeighed;
    // Nobody looks at the order that equal weights give.
    if (!isWeighed && !details.open) return page.byId("ranked").replaceChildren(plain(""));
    show(null);
    waiting = setTimeout(async () => {
      const stable = await page.stability(kind, () => mine !== run);
      if (stable && mine === run) show(stable);
    }, 200);
    return null;
  };

  page.nearText = () => (kind === "near" ? "" : kind);
  page.readNear = (text) => (kind = KINDS[text] ? text : "near");

  page.startWeigh = () => {
    if (!page.front || !page.front.objectives.length) return;
    build();
    update();
    page.events.on("choice.weigh", () => {
      if (page.byId("ranked")) page.byId("ranked").dataset.done = "no";
      page.schedule("weigh", update);
    });
    const mark = () => {
      const row = page.state.current ?? page.state.card;
      for (const line of page.byId("weigh").querySelectorAll("tr[data-row]")) line.classList.toggle("is-current", Number(line.dataset.row) === row);
    };
    for (const event of ["current", "card"]) page.events.on(`${event}.ranked`, mark);
    page.events.on("pins.ranked", () => known.front === page.front && page.byId("weigh").querySelector("tr[data-row]") && show(known.stable));
    page.events.on("choice.goals", () => page.schedule("goals", page.showGoals));
    const words = () => (page.isWeighed() ? `first by weights: design ${page.designOf(page.chosenRow())}` : "equal weights");
    let said = words();
    const say = page.afterPause(500, () => {
      if (page.front.rows && words() !== said) page.say((said = words()));
    });
    page.events.on("choice.said", say);
    page.events.on("front.weigh", () => page.schedule("weigh", update));
  };
}
