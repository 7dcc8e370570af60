// What is known of a design's drive: the value of an input or output by its name, and what has to be chosen because nobody says it.
{
  // `of` is a row of the front, or a design that is known without being on it. One of other changes has inputs of its own.
  const ofInput = (name, of) => (of.inputs ?? page.data.inputs ?? []).find((input) => input.name === name);
  const entryOf = (name, of) => {
    if (typeof of !== "number") return of.values.get(name);
    const column = page.front.byName.get(name);
    return column && { role: column.role, words: column.words, value: column.values[of] };
  };
  page.numberOfDesign = (of) => (typeof of === "number" ? page.designOf(of) : of.design);

  // What formulas of the study give a design, if the page knows it: { name: value }.
  page.knownGivens = new WeakMap(); // front -> row -> values, of a study in work
  const givenOf = (name, of) => {
    const known = of.givens ?? page.knownGivens.get(page.front)?.get(of);
    if (known) return known[name];
    const { givens } = page.data;
    return givens?.of[page.numberOfDesign(of)]?.[givens.names.indexOf(name)];
  };

  // A number with its unit, where it comes from and, where it varies over the scenarios, its ends; `null` if there is no such number.
  page.quantityOf = (name, of) => {
    const entry = entryOf(name, of);
    const input = ofInput(name, of);
    const isNumber = entry && !entry.words && Number.isFinite(entry.value);
    if (entry && entry.role === "design") return isNumber ? { name, value: entry.value, from: "design", least: input?.least, largest: input?.largest } : null;
    if (input && input.role === "fixed") return typeof input.value === "number" ? { name, value: input.value, from: "fixed" } : null;
    if (input && input.role === "drawn" && typeof input.value === "number") return { name, value: input.value, from: "drawn" };
    if (input && Number.isFinite(input.least)) return { name, value: (input.least + input.largest) / 2, from: "varied", least: input.least, largest: input.largest };
    if (isNumber) return { name, value: entry.value, from: "output" };
    const given = givenOf(name, of);
    return Number.isFinite(given) ? { name, value: given, from: "given" } : null;
  };

  // Reads the quantities of a drawing one after the other. `notes` says which lengths stand on a rule, not on the design.
  page.readerOf = (of) => {
    const notes = [];
    const missing = [];
    const number = (name) => {
      const found = page.quantityOf(name, of);
      if (!found) missing.push(name);
      else if (found.from === "varied" && found.least !== found.largest) notes.push(`${name}: it varies over the scenarios from ${page.short(found.least)} to ${page.short(found.largest)} and is drawn at ${page.short(found.value)}`);
      else if (found.from === "drawn") notes.push(`${name}: it has a distribution and is shown at its mean, ${page.short(found.value)}`);
      return found ? found.value : NaN;
    };
    // A length that the model has not: the value of a rule, which is told.
    const chosen = (what, value, rule) => {
      notes.push(`${what}, ${rule}`);
      return value;
    };
    // A length that a study may have, though the model has not.
    const known = (name) => page.quantityOf(name, of)?.value ?? null;
    return { number, known, chosen, notes, missing };
  };
}
