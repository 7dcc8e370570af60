// The drawing in a design's card: of models that are known, with a slider where the study has several ratios.
{
  const DRAWINGS = {
    "metal-cvt": (of, ratio) => page.drawVariator(of, true, ratio),
    "rubber-cvt": (of, ratio) => page.drawVariator(of, false, ratio),
    "flat-belt": (of) => page.drawFlatBelt(of),
    "timing-belt": (of) => page.drawTimingBelt(of),
    "pulley-load": (of) => page.drawPulley(of, false),
    pulley: (of) => page.drawPulley(of, true),
  };
  const STEPS = 200;
  page.knownSections = new WeakMap(); // front -> row -> outline, of a study in work
  let ratioShown = null; // stays from one card to the next

  const table = ({ heads, units, lines }) => {
    const head = heads.map((name, i) => page.element("th", { scope: "col", class: i ? "number" : "" }, name, units[i] ? page.element("div", { class: "unit" }, units[i]) : null));
    const body = lines.map(({ name, cells }) => page.element("tr", {}, page.element("th", { scope: "row" }, name), cells.map((cell) => page.element("td", { class: "number" }, cell))));
    return page.element("table", { class: "drive-table", "data-testid": "drive-table" }, page.element("thead", {}, page.element("tr", {}, heads[0] === "" ? page.element("td", {}) : null, head.slice(1))), page.element("tbody", {}, body));
  };

  const parts = ({ node, notes, table: lines, key }) => [
    node,
    page.element("p", { class: "hint", "data-testid": "drive-notes" }, key ? `${key} ` : "", notes.length ? `Not to scale: ${notes.join("; ")}.` : ""),
    lines ? table(lines) : null,
  ];

  // What is told later of a design, such as the section of a pulley or what formulas give: its drawing is made anew.
  let redraw = null;
  page.knowMore = (of, { section, givens, described }) => {
    const hasGivens = givens && Object.keys(givens).length > 0;
    if (typeof of !== "number") Object.assign(of, { section, inputs: described }, hasGivens ? { givens } : {});
    else {
      if (section) page.knownSections.set(page.front, new Map([[of, section]]));
      if (hasGivens) page.knownGivens.set(page.front, new Map([[of, givens]]));
      else if (!section) return;
    }
    redraw?.(of);
  };

  // `of`: a row of the front, or a design that is known without being on it.
  page.driveSection = (of) => {
    const draw = DRAWINGS[page.data.model && page.data.model.drive];
    if (!draw) return null;
    const ratio = page.ratioOf(of);
    const ends = page.data.model.drive.endsWith("-cvt") && ratio ? ratio.ends : null;
    let shown = ratio ? ratio.first : null;
    if (ends && ratioShown !== null && ratioShown >= ends[0] && ratioShown <= ends[1]) shown = ratioShown;
    // What is fixed under other changes the engine has to say first: with the values of this study the drawing would be of another drive.
    const isUntold = typeof of !== "number" && !of.inputs && !page.isOfShown(of);
    const first = isUntold ? { missing: ["the fixed inputs"] } : draw(of, shown);
    const title = page.element("h3", { id: "drive-title" }, "Drawn to scale");
    const section = (...children) => page.element("section", { class: "drive-section", "data-testid": "drive", "aria-labelledby": "drive-title" }, page.element("div", {}, title), children);
    if (first.none) return section(page.element("p", { class: "hint" }, `Not drawn: ${first.none}.`));
    // An input that a formula gives may be nowhere on the page.
    if (first.missing) {
      const made = section(page.element("p", { class: "hint" }, `Not drawn: the page does not know ${first.missing.join(", ")} of this design.`));
      redraw = (told) => told === of && made.isConnected && made.replaceWith(page.driveSection(of));
      return made;
    }
    const stage = page.element("div", { class: "stage drive-stage" }, first.node);
    const rest = page.element("div", {}, parts(first).slice(1).filter(Boolean));
    const show = (value) => {
      shown = ratioShown = value;
      const next = draw(of, value);
      if (next.none) return;
      stage.replaceChildren(next.node);
      rest.replaceChildren(...parts(next).slice(1).filter(Boolean));
    };
    let slider = null;
    if (ends) {
      const log = ends[0] > 0;
      const valueAt = (step) => (step <= 0 ? ends[0] : step >= STEPS ? ends[1] : log ? ends[0] * (ends[1] / ends[0]) ** (step / STEPS) : ends[0] + ((ends[1] - ends[0]) * step) / STEPS);
      const stepOf = (value) => Math.round(STEPS * (log ? Math.log(value / ends[0]) / Math.log(ends[1] / ends[0]) : (value - ends[0]) / (ends[1] - ends[0])));
      const said = page.element("output", { for: "drive-ratio" }, page.short(shown));
      const move = (event) => {
        const value = valueAt(Number(event.target.value));
        show(value);
        said.textContent = page.short(value);
        event.target.setAttribute("aria-valuetext", page.short(value));
      };
      const input = page.element("input", { type: "range", id: "drive-ratio", "data-testid": "drive-ratio", min: 0, max: STEPS, step: 1, value: stepOf(shown), "aria-valuetext": page.short(shown), input: move });
      // Arrow keys move the slider here, not the card.
      input.addEventListener("keydown", (event) => event.key.startsWith("Arrow") && event.stopPropagation());
      slider = page.element("div", { class: "drive-slider no-print" }, page.element("label", { for: "drive-ratio" }, "ratio"), input, said);
    }
    redraw = (told) => told === of && stage.isConnected && show(shown);
    const made = section(slider, stage, rest);
    page.saveButtons(title, `drive-${page.numberOfDesign(of)}`);
    return made;
  };
}
