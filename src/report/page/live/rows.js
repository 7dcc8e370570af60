// Controls of what has many parts: rows of cases, long lists, words to choose from, and distributions.
{
  const { controlHeading: heading } = page;
  const put = (part, value, original) => page.change({ [part]: value === original ? null : value });
  const given = (part, original) => page.changedValue(part) ?? original;

  // A cell of a row.
  const cell = (control, column, row, at) => {
    const original = row[column.name];
    const part = `${control.part}.${at + 1}.${column.name}`;
    const label = `${column.name}, row ${at + 1}`;
    if (original === undefined) return page.element("td", {});
    if (typeof original === "string") {
      const words = column.words?.includes(original) ? column.words : null;
      const read = () => given(part, original);
      return page.element("td", {}, words ? page.wordSelect({ part, label, words, read, write: (word) => put(part, word, original) }) : original);
    }
    const field = page.numberField({
      part,
      label: `${label}${column.unit ? `, in ${column.unit}` : ""}`,
      step: column.integer ? 1 : Math.abs(original) / 20 || 0.05,
      read: () => Number(given(part, original)),
      write: (value) => put(part, value, original),
    });
    const sync = () => {
      field.sync();
      field.classList.toggle("changed", Number(given(part, original)) !== original);
    };
    page.controlParts.push({ part, sync });
    return page.element("td", {}, field);
  };

  page.tableControl = (control) => {
    const head = control.columns.map((column) => page.element("th", { scope: "col", title: column.doc }, page.breakable(column.name)));
    const rows = control.rows.map((row, at) => page.element("tr", {}, page.element("th", { scope: "row" }, String(at + 1)), control.columns.map((column) => cell(control, column, row, at))));
    const table = page.element("table", {}, page.element("thead", {}, page.element("tr", {}, page.element("th", {}, "row"), head)), page.element("tbody", {}, rows));
    const box = page.element("div", { class: "case-rows", tabindex: 0, role: "group", "aria-label": `${control.name}: rows` }, table);
    return page.element("details", { class: "block", "data-control": control.part, open: control.rows.length < 8 }, page.element("summary", {}, page.breakable(control.name), page.element("span", { class: "muted" }, ` ${page.count(control.rows.length)} rows`)), box);
  };

  // Levels that are written one after the other: numbers, and words where the input takes some.
  page.listControl = (control) => {
    const { part, values, words } = control;
    const original = values.join(", ");
    const read = () => {
      const list = page.changedValue(part);
      return list === undefined ? original : list.replace(/^\[|\]$|"/g, "");
    };
    const level = (text) => (words.includes(text) ? text : page.numberOf(text));
    const also = words.length ? `, or ${words.join(", ")}` : "";
    const field = page.element("input", { type: "text", class: "list", autocomplete: "off", spellcheck: "false", "data-part": part, "aria-label": `${control.name}: levels` });
    field.addEventListener("change", (event) => {
      page.eventAt = event.timeStamp;
      const list = field.value.split(/[;\s]+|,(?=\s|$)|,(?!.*[;\s])/).filter(Boolean).map(level);
      const isRight = list.length > 0 && list.every((it) => typeof it === "string" || Number.isFinite(it));
      field.setCustomValidity(isRight ? "" : `Write numbers${also} with a space between them, such as 50 100 150`);
      if (!isRight) return field.reportValidity();
      delete field.dataset.typed;
      return page.change({ [part]: list.join(", ") === original ? null : `[${list.map((it) => JSON.stringify(it)).join(", ")}]` });
    });
    field.addEventListener("input", () => (field.dataset.typed = "1"));
    const sync = () => {
      if (!field.dataset.typed) field.value = read();
    };
    page.controlParts.push({ part, sync });
    return page.element("div", { class: "block", "data-control": part }, heading(control, page.element("span", { class: "muted" }, ` ${page.count(values.length)} levels`)), field);
  };

  // Words of which some are levels: one at least.
  page.wordsControl = (control) => {
    const { part, values, words } = control;
    const original = JSON.stringify(values);
    const chosen = () => {
      try {
        return JSON.parse(page.changedValue(part) ?? original);
      } catch {
        return values;
      }
    };
    const box = (word) => {
      const input = page.element("input", { type: "checkbox", "data-part": part, value: word });
      input.addEventListener("change", (event) => {
        page.eventAt = event.timeStamp;
        const now = chosen();
        // In the order of the file, what is new behind it.
        const list = [...new Set([...values, ...words])].filter((it) => (it === word ? input.checked : now.includes(it)));
        if (!list.length) return void (input.checked = true);
        const text = JSON.stringify(list).replaceAll(",", ", ");
        page.change({ [part]: JSON.stringify(list) === original ? null : text });
      });
      page.controlParts.push({ part, sync: () => (input.checked = chosen().includes(word)) });
      return page.element("label", { class: "word" }, input, ` ${word}`);
    };
    return page.element("div", { class: "block", "data-control": part }, heading(control), words.map(box));
  };
}
