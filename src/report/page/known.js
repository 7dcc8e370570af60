// Designs that are not on the front shown, such as those of a map's cell, of a list, or of other changes of the study: what is known of
// one, kept as pins keep it, and its card.
{
  const column = (name) => page.front?.byName.get(name) ?? (page.data.inputs || []).find((it) => it.name === name);

  // One value under its name, as pins have it. Texts are words; those that the front has are told by their place among its own.
  const entryOf = ({ name, unit, value }) => {
    const told = column(name);
    // Of words and numbers on one axis the numbers are words too.
    const word = typeof value === "string" || told?.words ? String(value) : null;
    const at = word === null || !told?.words ? -1 : told.words.indexOf(word);
    const entry = { value: at >= 0 ? at : value, text: word === null ? page.short(value) : page.wordText(word), unit: told?.unit ?? unit, role: told?.role ?? "report", words: word !== null, word, goal: told?.goal };
    return [name, entry];
  };

  // The inputs that a design's number stands for: its digits are the levels of the axes, the last axis changes fastest.
  const ofAxes = (design) => {
    if (!page.data.axes) return [];
    let rest = BigInt(design);
    const found = page.data.axes.toReversed().map(({ count, columns }) => {
      const level = Number(rest % BigInt(count));
      rest /= BigInt(count);
      return columns.map(({ name, values }) => ({ name, unit: "", value: values[level] }));
    });
    return rest === 0n ? found.toReversed().flat() : [];
  };

  // What a list of the page says of it.
  const ofLists = (design) =>
    [page.data.top, page.data.variants].filter(Boolean).flatMap(({ columns, units, rows, labels = [] }) => {
      const row = rows.find((it) => it[columns.indexOf("design_index")] === design);
      const isWord = (name, text) => labels.includes(name) || (text !== "" && !Number.isFinite(Number(text)));
      const entry = (name, at) => ({ name, unit: units ? units[at] : "", value: isWord(name, row[at]) ? row[at] : row[at] === "" ? NaN : Number(row[at]) });
      return row ? columns.map(entry).filter(({ name }) => name !== "design_index" && !name.endsWith("_scenario")) : [];
    });

  // `null` if the page knows nothing of it. `more`: { name, unit, value } of what else is known.
  page.knownOf = (design, more = []) => {
    if (!/^\d+$/.test(design)) return null;
    const entries = [...ofAxes(design), ...ofLists(design), ...more].map(entryOf);
    return entries.length ? { design, set: page.shownSet ?? [], values: new Map(entries) } : null;
  };

  // Which group of the card an entry stands in.
  const GROUPS = [["Inputs", (role) => role === "label" || role === "design"], ["Results", (role) => !["label", "design", "fixed", "operation", "uncertainty", "drawn"].includes(role)]];

  const build = (known) => {
    const { section, table, valueCell, command, evaluateOf, boundsOf, button } = page.cardParts;
    const { design, set, values } = known;
    const isOther = !page.isOfShown(known);
    const why = known.isFeasible === undefined ? "not on the front" : known.isFeasible ? "feasible, but not on the front: others are better" : `infeasible${known.status && known.status !== "ok" ? `: ${known.status}` : ""}`;
    const place = set.length && isOther ? `with ${set.join(", ")}` : isOther ? "of the study without changes" : why;
    const isPinned = page.isPinned(known);
    const buttons = page.element("div", { class: "card-buttons no-print" }, page.front?.rows ? button("card-pin", isPinned ? "Unpin this design (p)" : "Pin this design, to compare it (p)", isPinned ? "Unpin" : "Pin", page.pinCard, !isPinned && !page.canPin()) : null, button("card-print", "Print a data sheet of this design", "Print", () => page.printSheet()), button("card-close", "Close (Esc)", "×", page.closeCard));
    const head = page.element("div", { class: "card-head" }, page.element("div", {}, page.element("p", { class: "print-only sheet-study" }, page.data.title), page.element("h2", { id: "card-title" }, `Design ${design}`), page.element("p", { class: "muted" }, place)), buttons);
    const line = ([name, { value, text, unit, words, goal }]) => page.element("tr", {}, page.element("th", { scope: "row", title: column(name)?.doc }, page.breakable(name), goal ? page.element("span", { class: "unit" }, ` ${goal}`) : null), valueCell(name, words ? text : page.full(value), text, words || !Number.isFinite(value) ? "" : unit));
    const groups = GROUPS.map(([title, has]) => [title, [...values].filter(([, { role }]) => has(role))]);
    const margin = (bound) => {
      const name = bound.column?.name ?? bound.of;
      const value = values.get(name)?.value;
      if (!Number.isFinite(value)) return [];
      return boundsOf(bound).map(({ text, marginAt }) => page.element("tr", { class: marginAt(value) < 0 ? "infeasible" : null }, page.element("th", { scope: "row" }, page.breakable(name), page.element("div", { class: "unit" }, text)), valueCell(`margin of ${name}`, page.full(marginAt(value)), page.short(marginAt(value)), values.get(name).unit)));
    };
    const margins = isOther ? [] : (page.front?.constraints || []).flatMap(margin);
    return [
      head,
      ...groups.map(([title, entries]) => (entries.length ? section(title, table("values", entries.map(line))) : null)),
      margins.length ? section("Margins to the limits", table("values", margins)) : null,
      page.driveSection(known),
      page.data.kind === "live" ? page.element("section", { id: "all-outputs" }) : null,
      page.data.evaluate && !isOther ? section("Evaluate it", page.element("p", { class: "hint" }, "Run it in the folder in which this page was made."), command("every output of this design, in f64", evaluateOf(design), "evaluate")) : null,
    ].filter(Boolean);
  };

  page.openKnown = (known, takesFocus = true) => page.showCard(null, () => build(known), takesFocus, known);

  // Where the value of a pin or of such a design stands among those of a column: words by their place among the words that it has now.
  page.placeIn = (entry, { name, words }) => {
    const of = entry?.get(name);
    if (!of) return NaN;
    if (!words) return typeof of.value === "number" && !of.words ? of.value : NaN;
    const at = words.indexOf(of.word);
    return at >= 0 ? at : NaN;
  };

  // A design on the front, or what the page, a list or a map knows of it.
  page.openDesign = (design, more) => {
    const row = page.front ? page.rowOf(design) : -1;
    if (row >= 0) return page.openCard(row);
    const known = page.knownOf(design, more);
    return known ? page.openKnown(known) : null;
  };

  // The value of a column that all views show as the current one: of the design under the pointer, else of the one whose card is open.
  page.currentValue = (name) => {
    const { current, card, known } = page.state;
    const row = current ?? card;
    const column = page.front?.byName.get(name);
    if (!column) return NaN;
    return row !== null ? column.values[row] : page.placeIn(known?.values, column);
  };
}
