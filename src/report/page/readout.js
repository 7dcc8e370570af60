// Beside the matrix: the colour bar and the values of the point under the pointer; and small help for axes of words.
{
  // Words that are too long for their place on the axis are tilted.
  page.tiltWords = (axis, room) => {
    const longest = Math.max(...axis.selectAll("text").nodes().map((node) => node.textContent.length));
    if (longest * 6 < room) return;
    axis.selectAll("text").attr("transform", "rotate(-16)").attr("text-anchor", "end").attr("dx", "0.2em").attr("dy", "0.5em");
    page.shortenWords(axis, 13);
  };

  page.shortenWords = (axis, letters) => {
    axis.selectAll("text").each(function () {
      const word = this.textContent;
      if (word.length <= letters) return;
      this.textContent = `${word.slice(0, letters - 1)}…`;
      d3.select(this).append("title").text(word);
    });
  };

  page.showReadout = () => {
    const readout = page.byId("readout");
    if (!readout) return;
    const { state, front } = page;
    const known = state.current === null && state.card === null ? state.known : null;
    const row = state.current ?? state.card ?? page.chosenRow();
    const children = [page.legend(page.layoutWidth(readout) || Infinity)];
    if (known) {
      const entry = ([name, { text, unit, words, value }]) => page.element("div", {}, page.element("dt", { title: name }, name), page.element("dd", {}, text, words || !unit || Number.isNaN(value) ? "" : ` ${page.unit(unit)}`));
      children.push(page.element("div", { class: "readout-title" }, page.element("strong", {}, `design ${known.design}`), page.isOfShown(known) ? " (card, not on the front)" : " (card, with other changes)"));
      children.push(page.element("dl", {}, [...known.values].slice(0, 18).map(entry)));
    } else if (row !== null && row !== undefined) {
      const what = state.current !== null ? "pointed at" : state.card !== null ? "card" : page.chosenWord();
      const mark = row === page.chosenRow() && what !== page.chosenWord() ? `${what}, ${page.chosenWord()}` : what;
      const labels = front.shown.filter((column) => column.role === "label").map((column) => column.name);
      const all = [...new Set([...labels, ...state.matrix, ...state.parallel])];
      const names = page.withoutEnds(all, row).slice(0, 18 + labels.length);
      const entry = (name) => {
        const column = front.byName.get(name);
        const value = page.element("dd", {}, page.valueText(column, row), column.words || !column.unit || Number.isNaN(column.values[row]) ? "" : ` ${page.unit(column.unit)}`, page.intervalText(column, row), page.endOf(column, row) ? page.element("span", { class: "end", title: `at the ${page.endOf(column, row)} end of its range` }, page.endOf(column, row) === "upper" ? " ⤒" : " ⤓") : null);
        return page.element("div", {}, page.element("dt", { title: column.doc }, name), value);
      };
      children.push(page.element("div", { class: "readout-title" }, page.element("strong", {}, `design ${page.full(page.designOf(row))}`), ` (${mark})`));
      children.push(page.element("dl", {}, names.map(entry)));
      if (front.knee !== null) children.push(page.element("p", { class: "muted key" }, `◇ ${page.chosenWord()}, + ideal, ⤒ ⤓ at an end of its range`));
    }
    readout.replaceChildren(...children);
  };

  page.startReadout = () => {
    page.showReadout();
    for (const event of ["current", "card", "colour", "theme", "front", "choice"]) page.events.on(`${event}.readout`, () => page.schedule("readout", page.showReadout));
    page.events.on("columns.readout", () => page.schedule("readout", page.showReadout));
  };
}
