// Chooses the columns of the two plots, and ranges as numbers: everything that a brush can do, from the keyboard.
{
  const MOST = 8; // columns of the matrix, 28 cells

  page.toggleChooser = (open = page.byId("chooser").hidden) => {
    const chooser = page.byId("chooser");
    chooser.hidden = !open;
    page.byId("columns").setAttribute("aria-expanded", String(open));
    if (open) {
      build();
      chooser.querySelector("input").focus({ preventScroll: true });
    } else page.byId("columns").focus();
  };

  // A new column goes to its place in the order of the columns, so that the matrix always has the same order.
  const choose = (which, name, on) => {
    const { state, front } = page;
    const names = state[which].filter((other) => other !== name);
    if (on && which === "matrix") {
      const rank = (other) => front.shown.findIndex((column) => column.name === other);
      const at = names.findIndex((other) => rank(other) > rank(name) && !front.byName.get(other).goal);
      names.splice(at < 0 ? names.length : at, 0, name);
    } else if (on) names.push(name);
    page.chooseColumns(which, names);
    update();
  };

  const check = (column, which) =>
    page.element("input", {
      type: "checkbox",
      "data-which": which,
      "data-column": column.name,
      "aria-label": `${column.name} in ${which === "matrix" ? "the scatter matrix" : "the parallel axes"}`,
      change: (event) => choose(which, column.name, event.target.checked),
    });

  const setRange = (column, inputs) => {
    const read = (input, otherwise) => (input.value.trim() === "" || !Number.isFinite(Number(input.value)) ? otherwise : Number(input.value));
    if (inputs.every((input) => input.value.trim() === "")) return page.brushAxis(column.name, null);
    const { state } = page;
    const shown = state.parallel.includes(column.name) || (state.matrix.length === 1 && state.matrix[0] === column.name);
    if (!shown) page.chooseColumns("parallel", [...state.parallel, column.name]);
    const { low, high } = page.front.byName.get(column.name);
    const range = [read(inputs[0], low), read(inputs[1], high)];
    page.brushAxis(column.name, range[0] <= range[1] ? range : [range[1], range[0]]);
  };

  const line = (column) => {
    const bound = (which) => page.element("input", { type: "number", step: "any", class: "bound", "data-bound": which, "data-column": column.name, "aria-label": `${column.name}, ${which === "low" ? "at least" : "at most"}` });
    const inputs = [bound("low"), bound("high")];
    inputs.forEach((input) => input.addEventListener("change", () => setRange(column, inputs)));
    const words = (word, i) => page.element("button", { type: "button", class: "word-button", click: () => setWord(column, i), "aria-label": `${column.name}: only ${page.wordText(word)}` }, page.wordText(word));
    const range = column.words ? page.element("td", { colspan: 2 }, column.words.map(words)) : inputs.map((input) => page.element("td", {}, input));
    return page.element("tr", {}, page.element("th", { scope: "row", title: column.doc }, column.name), page.element("td", {}, page.unit(column.unit)), page.element("td", {}, check(column, "matrix")), page.element("td", {}, check(column, "parallel")), range);
  };

  const setWord = (column, i) => {
    if (!page.state.parallel.includes(column.name)) page.chooseColumns("parallel", [...page.state.parallel, column.name]);
    page.brushAxis(column.name, [i - 0.4, i + 0.4]);
  };

  // What the lines are built for: columns of another study, or other words, ask for others.
  const keyOf = () => page.front.shown.map(({ name, words }) => [name, ...(words ?? [])].join()).join(";");
  let built = null;
  const build = () => {
    if (built !== keyOf()) {
      const isFirst = built === null;
      built = keyOf();
      const head = ["column", "unit", "matrix", "axes", "at least", "at most"].map((name) => page.element("th", { scope: "col" }, name));
      const bodies = Object.entries(page.columnGroups).map(([role, label]) => {
        const columns = page.columnsOf(role);
        return columns.length ? page.element("tbody", {}, page.element("tr", { class: "group" }, page.element("th", { colspan: 6, scope: "rowgroup" }, label)), columns.map(line)) : null;
      });
      const close = page.element("button", { type: "button", click: () => page.toggleChooser(false) }, "Close");
      page.keepFocus(page.byId("chooser"), () => page.byId("chooser").replaceChildren(page.element("div", { class: "scroll" }, page.element("table", { class: "columns" }, page.element("thead", {}, page.element("tr", {}, head)), bodies)), close));
      if (isFirst) page.byId("chooser").addEventListener("keydown", (event) => event.key === "Escape" && page.toggleChooser(false));
    }
    update();
  };

  const update = () => {
    if (built === null || page.byId("chooser").hidden) return null;
    if (built !== keyOf()) return build();
    const { state } = page;
    const full = state.matrix.length >= MOST;
    for (const box of page.byId("chooser").querySelectorAll("input[type=checkbox]")) {
      box.checked = state[box.dataset.which].includes(box.dataset.column);
      box.disabled = box.dataset.which === "matrix" && full && !box.checked;
    }
    for (const input of page.byId("chooser").querySelectorAll(".bound")) {
      const range = state.axes.get(input.dataset.column);
      input.placeholder = page.short(page.front.byName.get(input.dataset.column)[input.dataset.bound]).replace("−", "-");
      if (input !== document.activeElement) input.value = range ? String(range[input.dataset.bound === "low" ? 0 : 1]) : "";
    }
  };

  page.startChooser = () => {
    page.events.on("selection.chooser", () => page.schedule("chooser", update));
    page.events.on("front.chooser", () => page.schedule("chooser", update));
    page.events.on("columns.chooser", () => page.schedule("chooser", update));
  };
}
