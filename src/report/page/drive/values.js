// What is known of a design's drive: the value of an input or output by its name, and what has to be chosen because nobody says it.
{
  const ofInput = (name) => (page.data.inputs || []).find((input) => input.name === name);

  // What formulas of the study give a design, if the page knows it: { name: value }.
  page.knownGivens = new WeakMap(); // front -> row -> values, of a study in work
  const givenOf = (name, row) => {
    const known = page.knownGivens.get(page.front)?.get(row);
    if (known) return known[name];
    const { givens } = page.data;
    return givens?.of[page.designOf(row)]?.[givens.names.indexOf(name)];
  };

  // A number with its unit, where it comes from and, where it varies over the scenarios, its ends; `null` if there is no such number.
  page.quantityOf = (name, row) => {
    const column = page.front.byName.get(name);
    const input = ofInput(name);
    if (column && column.role === "design") return column.words || !Number.isFinite(column.values[row]) ? null : { name, value: column.values[row], from: "design", least: input?.least, largest: input?.largest };
    if (input && input.role === "fixed") return typeof input.value === "number" ? { name, value: input.value, from: "fixed" } : null;
    if (input && input.role === "drawn" && typeof input.value === "number") return { name, value: input.value, from: "drawn" };
    if (input && Number.isFinite(input.least)) return { name, value: (input.least + input.largest) / 2, from: "varied", least: input.least, largest: input.largest };
    if (column && !column.words && Number.isFinite(column.values[row])) return { name, value: column.values[row], from: "output" };
    const given = givenOf(name, row);
    return Number.isFinite(given) ? { name, value: given, from: "given" } : null;
  };

  // Reads the quantities of a drawing one after the other. `notes` says which lengths stand on a rule, not on the design.
  page.readerOf = (row) => {
    const notes = [];
    const missing = [];
    const number = (name) => {
      const found = page.quantityOf(name, row);
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
    const known = (name) => page.quantityOf(name, row)?.value ?? null;
    return { number, known, chosen, notes, missing };
  };
}
