// The bar that stays visible: how many designs are selected, by which ranges, and which column colours the points.
{
  const chip = (text, remove) =>
    page.element("span", { class: "chip" }, text, page.element("button", { type: "button", class: "no-print", "aria-label": `Remove the selection ${text}`, title: "Remove", click: remove }, "×"));

  const rangeText = (name, [low, high]) => {
    const column = page.front.byName.get(name);
    if (column.words) {
      const words = column.words.filter((_, i) => i >= low && i <= high).map(page.wordText);
      return `${name} ${words.length ? words.join(", ") : "none"}`;
    }
    return `${name} ${page.short(low)} to ${page.short(high)}${column.unit ? ` ${page.unit(column.unit)}` : ""}`;
  };

  // Ranges within which the front would be another.
  const doubtfulRanges = () => {
    const { state } = page;
    const ranges = [...state.axes, ...[...state.cells.values()].flatMap(({ x, y, xRange, yRange }) => [[x, xRange], [y, yRange]])];
    return ranges.filter(([name, range]) => !page.isOfFront(name, range));
  };

  // The bounds that such ranges stand for, without those that hold for the whole front. A value that is the lowest over the scenarios can
  // have a lower bound only: an upper one would be on the highest. In a single scenario both are the same.
  const isSingle = () => page.data.study?.scenarios === 1 && !page.data.drawn;
  const boundsOf = ([name, [low, high]]) => {
    const { words, role, end, low: least, high: most } = page.front.byName.get(name);
    if (words) return { name };
    const may = (which) => role === "design" || isSingle() || end === which;
    return { name, ...(low > least && may("lowest") ? { min: low } : {}), ...(high < most && may("highest") ? { max: high } : {}) };
  };

  // Ends of ranges that no constraint stands for.
  const withoutBound = ([name, [low, high]]) => {
    const { words, role, end, low: least, high: most } = page.front.byName.get(name);
    if (words || role === "design" || isSingle()) return null;
    const left = [low > least && end !== "lowest" ? "at least" : "", high < most && end !== "highest" ? "at most" : ""].filter(Boolean);
    if (!left.length) return null;
    return end ? `${name} is the ${end} over the scenarios: a constraint “${left.join(", ")}” would be on the ${end === "lowest" ? "highest" : "lowest"}. ` : null;
  };

  const remedy = (doubtful) => {
    // Of several ranges of one column what all of them leave.
    const all = d3.group(doubtful.map(boundsOf), (it) => it.name);
    const ends = (which, of, choose) => (of.some((it) => it[which] !== undefined) ? { [which]: choose(of, (it) => it[which]) } : {});
    const both = [...all].map(([name, of]) => ({ name, ...ends("min", of, d3.max), ...ends("max", of, d3.min) }));
    const bounds = both.filter((it) => it.min !== undefined || it.max !== undefined);
    if (!bounds.length) return [];
    if (page.constrain) {
      const make = () => {
        page.clearBrushes();
        bounds.forEach(({ name, ...ends }) => page.constrain(name, ends));
      };
      return [page.element("button", { type: "button", id: "make-constraint", class: "no-print", click: make }, bounds.length > 1 ? "Make them constraints" : "Make it a constraint")];
    }
    const { evaluate } = page.data;
    if (!evaluate) return [];
    const set = bounds.flatMap(({ name, ...ends }) => Object.entries(ends).map(([key, value]) => ` --set constraints.${name}.${key}=${value}`));
    const command = evaluate.replace(" eval ", " explore ").replace(" --design {design}", "") + set.join("");
    return ["With the engine: ", page.element("code", { tabindex: 0 }, command)];
  };

  const update = () => page.keepFocus(page.byId("bar"), show);
  const show = () => {
    const { state, front } = page;
    page.byId("selected-count").textContent = page.count(page.selectedCount);
    page.byId("selected-share").textContent = ` of ${page.count(front.rows)} design${front.rows === 1 ? "" : "s"} on the front selected`;
    page.byId("clear").disabled = !page.brushed();
    const chips = [];
    for (const [name, range] of state.axes) chips.push(chip(rangeText(name, range), () => page.brushAxis(name, null)));
    for (const { x, y, xRange, yRange } of state.cells.values()) chips.push(chip(`${rangeText(x, xRange)} and ${rangeText(y, yRange)}`, () => page.brushCell(x, y, null)));
    page.byId("chips").replaceChildren(...chips);
    const note = page.byId("brush-note");
    const doubtful = doubtfulRanges();
    note.hidden = !doubtful.length;
    if (!doubtful.length) return;
    const names = [...new Set(doubtful.map(([name]) => name))].join(", ");
    note.replaceChildren(`Only designs of the front are here. Within a range of ${names} other designs may be the best, which are beaten now. `, ...doubtful.map(withoutBound).filter(Boolean), ...remedy(doubtful));
  };

  const groups = { label: "Labels", design: "Design inputs", objective: "Objectives", constraint: "Constraints", report: "Report columns", output: "Other outputs" };

  // Columns that can be an axis or a colour, by what they are. Labels of very many texts, such as part numbers, are only in the tables.
  page.columnsOf = (role) => page.front.shown.filter((column) => column.role === role && !(role === "label" && column.words.length > 40));

  // Options of all columns, grouped by what they are.
  page.columnOptions = (select, chosen) => {
    for (const [role, label] of Object.entries(groups)) {
      const columns = page.columnsOf(role);
      if (!columns.length) continue;
      const option = (column) => page.element("option", { value: column.name, selected: column.name === chosen }, page.withUnit(column.name, column.unit));
      select.append(page.element("optgroup", { label }, columns.map(option)));
    }
  };
  page.columnGroups = groups;

  page.startBar = () => {
    const bar = page.byId("bar");
    bar.hidden = false;
    const colour = page.element("select", { id: "colour", "data-testid": "colour", change: () => page.setColour(colour.value) });
    page.columnOptions(colour, page.state.colour);
    const columns = page.element("button", { type: "button", id: "columns", "data-testid": "columns", "aria-expanded": "false", "aria-controls": "chooser", click: () => page.toggleChooser() }, "Columns and ranges");
    bar.append(
      page.element("div", { class: "counts", role: "status" }, page.element("strong", { id: "selected-count", "data-testid": "selected-count" }), page.element("span", { id: "selected-share" })),
      page.element("div", { id: "chips" }),
      page.element("p", { id: "brush-note", "data-testid": "brush-note", class: "hint", hidden: true }),
      page.element("div", { class: "controls no-print" }, page.element("label", {}, "Colour ", colour), columns, page.element("button", { type: "button", id: "clear", "data-testid": "clear", click: page.clearBrushes }, "Clear")),
    );
    update();
    page.events.on("selection.bar", () => page.schedule("bar", update));
    page.events.on("front.bar", () => {
      if (!page.front.byName.has(colour.value) || colour.dataset.columns !== page.state.columns) {
        colour.replaceChildren();
        page.columnOptions(colour, page.state.colour);
        colour.dataset.columns = page.state.columns;
      }
      page.schedule("bar", update);
    });
    page.events.on("colour.bar", () => (colour.value = page.state.colour));
  };
}
