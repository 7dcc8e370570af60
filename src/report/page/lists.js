// Tables of the result's files, unchanged: the best designs, all designs, the papers' tables.
{
  // More rows than a reader would scroll through are only in the file.
  const MOST = 1000;
  const SHEET = 160; // px of letters beside each other: 20 columns have room in letters of 8 px

  const shorten = (text) => (text !== "" && Number.isFinite(Number(text)) ? page.short(Number(text)) : text);

  // Which lines are of the design that all views show, by its number.
  const markCurrent = (body) => {
    const row = page.state.current ?? page.state.card;
    const design = row === null || !page.front ? (page.state.known?.design ?? null) : page.designOf(row);
    for (const line of body.rows) line.classList.toggle("is-current", line.dataset.row === design);
  };

  // The letters of pins of this very study, behind the numbers of their designs.
  const markPins = (body, index) => {
    const letters = new Map(page.pins().filter((pin) => !pin.set.length).map(({ design, letter }) => [design, letter]));
    body.querySelectorAll(".pin-letter").forEach((it) => it.remove());
    for (const line of body.rows) if (letters.has(line.dataset.row)) line.cells[index].append(page.element("span", { class: "pin-letter" }, letters.get(line.dataset.row)));
  };

  const block = (id, title, hint, { columns, units, rows, of = rows.length, labels = [] }) => {
    // A label may look like a number, such as 007, and stays as it is.
    const words = columns.map((name, at) => labels.includes(name) || rows.some((row) => row[at] !== "" && !Number.isFinite(Number(row[at]))));
    // On paper the numbers of scenarios would take the room of the values.
    const kind = (at) => (words[at] ? "" : columns[at].endsWith("_scenario") ? "number of-scenario" : "number");
    const head = columns.map((name, at) => page.element("th", { scope: "col", class: kind(at) }, page.breakable(name), units && units[at] ? page.element("span", { class: "unit" }, page.unit(units[at])) : null));
    const index = columns.indexOf("design_index");
    const shown = (text, at) => (at === index || labels.includes(columns[at]) ? text : shorten(text));
    const line = (row) => page.element("tr", { class: row[columns.indexOf("feasible")] === "no" ? "infeasible" : null, "data-row": index < 0 ? null : row[index], tabindex: index < 0 ? null : -1 }, row.map((text, at) => page.element("td", { class: kind(at), title: text }, shown(text, at))));
    const body = page.element("tbody", {}, rows.slice(0, MOST).map(line));
    const table = page.element("table", { class: index < 0 ? null : "opens" }, page.element("thead", {}, page.element("tr", {}, head)), body);
    // On paper all columns stand beside each other: letters are as large as their number allows.
    table.style.setProperty("--printed", `${Math.min(8, SHEET / columns.filter((_, at) => kind(at) !== "number of-scenario").length).toFixed(1)}px`);
    if (index >= 0) {
      page.openableRows(body, (at) => page.openDesign(at.dataset.row))();
      for (const event of ["current", "card"]) page.events.on(`${event}.${id}`, () => markCurrent(body));
      page.events.on(`pins.${id}`, () => markPins(body, index));
      markPins(body, index);
    }
    const rest = (most, kind) => (of > most ? page.element("span", { class: kind }, ` The first ${most} of ${page.count(of)} rows are shown.`) : null);
    const paper = index < 0 ? rest(MOST, "print-only") : rest(page.mostPrinted, "print-only");
    return page.element("section", { id, "data-testid": id, "aria-labelledby": `${id}-title` }, page.element("h2", { id: `${id}-title` }, title), page.element("p", { class: "hint" }, hint, rest(MOST, "no-print"), paper), page.element("div", { class: "scroll tall", tabindex: index < 0 ? 0 : null, role: "region", "aria-label": `${title}, the table` }, table));
  };

  page.startLists = () => {
    const { top, variants, tables } = page.data;
    const found = [];
    if (top && top.rows.length) found.push(block("top", "Best single designs", `The best of all feasible designs by ${top.by || "one quantity"}, on the front or not. File: top.csv.`, top));
    if (variants && variants.rows.length) found.push(block("variants", "Every design", "Feasible or not, each value at its worst scenario. File: variants.csv.", variants));
    // On paper a map would leave half a sheet empty below them.
    const place = () => page.byId(page.printing ? "maps" : "tally").after(...found);
    place();
    page.events.on("layout.lists", place);
    page.byId("study").before(...(tables || []).map((table) => block(`table-${table.id}`, `${table.group}: ${table.title}`, `${table.caption} (${table.csv})`, table)));
  };
}
