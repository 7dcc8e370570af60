// The selected designs as a table, sortable by each column, and as CSV with every digit.
{
  const MOST = 200;
  page.mostPrinted = 40; // rows of designs, as the style of printed pages has it
  let sort = { name: null, down: false };
  let body, note, heads, oneStop;

  const columnsShown = () => {
    const { front, state } = page;
    const wanted = front.shown.filter((column) => column.role !== "output" || state.parallel.includes(column.name) || state.matrix.includes(column.name));
    return front.index ? [front.index, ...wanted] : wanted;
  };

  const sortedRows = () => {
    const rows = page.selected();
    const column = sort.name ? page.front.byName.get(sort.name) : null;
    if (!column) return rows;
    const { values } = column;
    const sign = sort.down ? -1 : 1;
    const key = (row) => (Number.isNaN(values[row]) ? Infinity : sign * values[row]); // absent ones last
    return rows.sort((a, b) => key(a) - key(b) || a - b);
  };

  const csvText = () => {
    const columns = [page.front.index, ...page.front.shown].filter(Boolean);
    const field = (text) => (/[",\n]/.test(text) ? `"${text.replace(/"/g, '""')}"` : text);
    const lines = [columns.flatMap((column) => (column.scenarios ? [column.name, `${column.name}_scenario`] : [column.name])).map(field).join(",")];
    for (const row of sortedRows()) {
      const fields = columns.flatMap((column) => {
        const value = page.valueText(column, row, page.full);
        if (!column.scenarios) return [value];
        return [value, column.scenarios[row] === page.noScenario ? "" : String(column.scenarios[row])];
      });
      lines.push(fields.map(field).join(","));
    }
    return `${lines.join("\n")}\n`;
  };
  page.selectedCsv = csvText;

  const sortBy = (name) => {
    sort = { name, down: sort.name === name ? !sort.down : false };
    update();
    page.say(`sorted by ${name}, ${sort.down ? "the largest" : "the least"} first`);
  };

  const update = () => {
    const columns = columnsShown();
    const head = (column) => {
      const direction = sort.name !== column.name ? "none" : sort.down ? "descending" : "ascending";
      const arrow = { none: "", ascending: " ↑", descending: " ↓" }[direction];
      const button = page.element("button", { type: "button", "data-focus": `sort ${column.name}`, click: () => sortBy(column.name), title: column.doc }, column === page.front.index ? "design" : column.name, arrow);
      return page.element("th", { scope: "col", "aria-sort": direction, "data-column": column.name, class: column.words ? "" : "number" }, button, column.unit ? page.element("span", { class: "unit" }, page.unit(column.unit)) : null);
    };
    page.keepFocus(heads, () => heads.replaceChildren(...columns.map(head)));
    const rows = sortedRows();
    const knee = page.chosenRow();
    const line = (row) => {
      const cell = (column) => page.element("td", { class: column.words ? "" : "number" }, page.valueText(column, row), column === page.front.index ? [page.letterOf(row) ? page.element("span", { class: "pin-letter" }, page.letterOf(row)) : null, row === knee ? page.element("span", { class: "mark" }, ` ${page.chosenWord()}`) : null].filter(Boolean) : []);
      return page.element("tr", { "data-row": row, "data-focus": `row ${page.designOf(row)}`, class: row === knee ? "is-knee" : "", tabindex: -1, "aria-label": `design ${page.designOf(row)}: open its card` }, columns.map(cell));
    };
    const marked = new Set([...page.pins().filter(page.isOfShown).map((pin) => page.rowOf(pin.design)), page.state.card]);
    const beyond = rows.length > MOST ? rows.slice(MOST).filter((row) => marked.has(row)) : [];
    page.keepFocus(body, () => body.replaceChildren(...rows.slice(0, MOST).concat(beyond).map(line)));
    const first = (most, more) => (rows.length > most ? `The first ${most} of ${page.count(rows.length)} are shown${more}; the CSV has them all.` : "");
    const said = rows.length ? first(MOST, beyond.length ? ", and what is pinned or open" : "") : "No design is in all of the selected ranges.";
    note.replaceChildren(page.element("span", { class: "no-print" }, said), page.element("span", { class: "print-only" }, rows.length ? first(page.mostPrinted, "") : said));
    page.byId("csv").disabled = !rows.length;
    oneStop(body.contains(document.activeElement) ? document.activeElement : null);
    page.oneStop(heads, "button", { below: body.querySelector("tr") });
    markCurrent();
  };

  const markCurrent = () => {
    for (const marked of body.querySelectorAll(".is-current")) marked.classList.remove("is-current");
    const row = page.state.current ?? page.state.card;
    if (row !== null) body.querySelector(`[data-row="${row}"]`)?.classList.add("is-current");
  };

  const rowAt = (event) => {
    const line = event.target.closest("tr[data-row]");
    return line ? Number(line.dataset.row) : null;
  };

  page.startTable = () => {
    const section = page.byId("table-section");
    section.hidden = false;
    heads = page.element("tr", {});
    body = page.element("tbody", {});
    note = page.element("p", { class: "hint" });
    const save = () => page.download(`${page.data.model ? page.data.model.name : "designs"}-selected.csv`, "text/csv", csvText());
    const csv = page.element("button", { type: "button", id: "csv", "data-testid": "csv", class: "no-print", click: save }, "Download as CSV");
    const scroll = page.element("div", { class: "scroll tall" }, page.element("table", { id: "designs", "data-testid": "designs" }, page.element("thead", {}, heads), body));
    section.append(page.element("div", { class: "title-line" }, page.element("h2", { id: "table-title" }, "Selected designs"), csv), note, scroll);
    oneStop = page.openableRows(body, (line) => page.openCard(Number(line.dataset.row)));
    body.addEventListener("pointerover", (event) => page.setCurrent(rowAt(event)));
    body.addEventListener("pointerleave", () => page.setCurrent(null));
    body.addEventListener("focusin", (event) => page.setCurrent(rowAt(event)));
    update();
    // Not on every move of a brush, but after a pause.
    const later = page.afterPause(80, update);
    page.events.on("selection.table", later);
    page.events.on("columns.table", later);
    page.events.on("front.table", later);
    page.events.on("choice.table", later);
    page.events.on("pins.rows", later);
    page.events.on("current.table", markCurrent);
    page.events.on("card.table", () => {
      markCurrent();
      const { card } = page.state;
      // A design that is listed for its card alone comes and goes with it.
      if (body.rows.length > MOST || (card !== null && page.mask[card] && !body.querySelector(`[data-row="${card}"]`))) later();
    });
  };
}
