// The card of one design: its inputs, its outputs in the worst case, and its distances from the limits and from the best values.
{
  let opener = null; // where the focus goes back to

  // Rows that the arrow keys step through: those selected, or the whole front.
  const step = (by) => {
    const { card } = page.state;
    const rows = page.mask.length;
    for (let row = card + by; row >= 0 && row < rows; row += by) {
      if (!page.mask[row]) continue;
      page.openCard(row);
      return page.announce(row);
    }
    return null;
  };

  const valueCell = (name, full, text, unit, ending = null) =>
    page.element("td", { class: `number${String(text).length > 24 ? " long" : ""}` }, page.element("span", { "data-name": name, "data-value": full, title: full }, text), unit ? page.element("span", { class: "unit" }, ` ${page.unit(unit)}`) : null, ending);

  const endMark = (column, row) => {
    const end = page.endOf(column, row);
    return end ? page.element("div", { class: "end" }, `${end} end of its range`) : null;
  };

  const columnCell = (column, row) => valueCell(column.name, page.valueText(column, row, page.full), page.valueText(column, row), column.words || Number.isNaN(column.values[row]) ? "" : column.unit, endMark(column, row));

  const scenarioText = (number) => {
    const { scenarios } = page.data;
    const values = scenarios && scenarios.rows ? scenarios.rows[String(number)] : null;
    if (!values) return "";
    return scenarios.columns.map(({ name, unit }, i) => `${name} ${page.short(values[i])}${unit && typeof values[i] === "number" ? ` ${page.unit(unit)}` : ""}`).join(", ");
  };

  const scenarioCell = (column, row) => {
    const number = column.scenarios ? column.scenarios[row] : page.noScenario;
    if (number === page.noScenario) return page.element("td", {});
    return page.element("td", { class: "scenario", title: scenarioText(number) }, page.element("span", { "data-scenario": String(number) }, `#${number}`));
  };

  const section = (title, ...children) => page.element("section", {}, page.element("h3", {}, title), children);
  const table = (kind, lines) => page.element("table", { class: kind }, page.element("tbody", {}, lines));
  const heading = (column) => page.element("th", { scope: "row", title: column.doc }, page.breakable(column.name));

  const inputs = (row) => {
    const { front, data } = page;
    const line = (name, cell, doc) => page.element("tr", {}, page.element("th", { scope: "row", title: doc }, page.breakable(name)), cell);
    const drawn = (data.inputs || []).filter((input) => input.role === "drawn").map((input) => line(input.name, page.element("td", { class: "number", title: input.drawn }, page.grouped(input.over), input.unit && !input.over.startsWith("times") ? page.element("span", { class: "unit" }, ` ${page.unit(input.unit)}`) : null), input.doc));
    const chosen = front.shown.filter((column) => column.role === "label" || column.role === "design").map((column) => line(column.name, columnCell(column, row), column.doc));
    const fixed = (data.inputs || []).filter((input) => input.role === "fixed").map((input) => line(input.name, valueCell(input.name, page.full(input.value), page.short(input.value), typeof input.value === "number" ? input.unit : ""), input.doc));
    const ranged = (data.inputs || []).filter((input) => input.role === "operation" || input.role === "uncertainty").map((input) => line(input.name, page.element("td", { class: "number" }, input.over || rangeInScenarios(input.name), input.unit ? page.element("span", { class: "unit" }, ` ${page.unit(input.unit)}`) : null), input.doc));
    const group = (title, lines) => (lines.length ? [page.element("h4", {}, title), table("values", lines)] : []);
    return section("Inputs", group("chosen", chosen), group("varied over the scenarios", ranged), group("drawn from a distribution", drawn), group("fixed", fixed));
  };

  const rangeInScenarios = (name) => {
    const { scenarios } = page.data;
    const at = scenarios ? scenarios.columns.findIndex((column) => column.name === name) : -1;
    if (at < 0) return "";
    const values = [...new Set(Object.values(scenarios.rows).map((row) => row[at]))];
    if (values.some((value) => typeof value === "string")) return values.join(", ");
    const [low, high] = d3.extent(values);
    return low === high ? page.short(low) : `${page.short(low)} to ${page.short(high)}`;
  };

  // A share of 0 to 1 as a bar, with the number beside it.
  const bar = (share, kind, text) => {
    const fill = page.element("span", { class: `fill ${kind}` });
    fill.style.width = `${(100 * Math.max(0, Math.min(1, share))).toFixed(1)}%`;
    return page.element("span", { class: "meter", role: "img", "aria-label": text, title: text }, fill);
  };

  const objectives = (row) => {
    const { front } = page;
    const line = ({ column, goal }) => {
      const span = column.high - column.low;
      const value = column.values[row];
      const share = span > 0 ? (goal === "max" ? (value - column.low) / span : (column.high - value) / span) : 1;
      const text = span > 0 ? `${(100 * share).toFixed(0)} % of the way from the worst to the best on the front` : "the same for every design on the front";
      return page.element("tr", {}, page.element("th", { scope: "row", title: column.doc }, page.breakable(column.name), page.element("span", { class: "unit" }, ` ${goal}`)), columnCell(column, row), page.element("td", { class: "bar-cell" }, bar(share, "place", text), page.element("span", { class: "bar-text" }, `${(100 * share).toFixed(0)} %`)));
    };
    return front.objectives.length ? section("Objectives, from worst to best on the front", table("bars", front.objectives.map(line))) : null;
  };

  // Each bound of a constraint, and how far a value stays from it.
  const boundsOf = ({ min, max, above, below }) => {
    const given = (value) => value !== null && value !== undefined;
    const bounds = [];
    for (const [bound, text] of [[min, "at least"], [above, "above"]]) if (given(bound)) bounds.push({ text: `${text} ${page.short(bound)}`, marginAt: (value) => value - bound });
    for (const [bound, text] of [[max, "at most"], [below, "below"]]) if (given(bound)) bounds.push({ text: `${text} ${page.short(bound)}`, marginAt: (value) => bound - value });
    return bounds;
  };

  const margins = (row) => {
    const { front } = page;
    // What chosen designs have in the fresh draws is measured by the bound that the draws which chose them had to keep.
    const wanted = front.constraints.find(({ column }) => column.name === "yield_screened");
    const fresh = front.shown.find((column) => column.name === "yield");
    const constraints = wanted && fresh ? [...front.constraints, { ...wanted, column: fresh }] : front.constraints;
    const lines = constraints.flatMap((constraint) =>
      boundsOf(constraint).map(({ text, marginAt }) => {
        const { column } = constraint;
        const margin = (at) => marginAt(column.values[at]);
        const largest = Math.max(margin(rowOfExtreme(column, "low")), margin(rowOfExtreme(column, "high")));
        const share = largest > 0 ? margin(row) / largest : 0;
        const said = `margin ${page.short(margin(row))}, the largest on the front is ${page.short(largest)}`;
        return page.element(
          "tr",
          {},
          page.element("th", { scope: "row", title: column.doc }, page.breakable(column.name), page.element("div", { class: "unit" }, text)),
          columnCell(column, row),
          page.element("td", { class: "bar-cell" }, bar(share, "margin", said), page.element("span", { class: "bar-text", "data-margin": String(margin(row)), title: said }, page.short(margin(row)))),
        );
      }),
    );
    return lines.length ? section("Margins, relative to the largest on the front", table("bars", lines)) : null;
  };

  const rowOfExtreme = (column, end) => column.values.indexOf(column[end]);

  const outputs = (row) => {
    const { front } = page;
    const columns = front.shown.filter((column) => column.role !== "label" && column.role !== "design");
    const line = (column) => page.element("tr", {}, heading(column), columnCell(column, row), scenarioCell(column, row));
    const lines = columns.map(line);
    const numbers = [...new Set(columns.filter((column) => column.scenarios).map((column) => column.scenarios[row]))].filter((number) => number !== page.noScenario).sort((a, b) => a - b);
    const described = numbers.filter((number) => scenarioText(number)).map((number) => page.element("tr", {}, page.element("th", { scope: "row" }, `#${number}`), page.element("td", {}, scenarioText(number))));
    const note = front.complete === false ? page.element("p", { class: "notice" }, "The other outputs were not computed, because the front has so many designs; the command below prints them.") : null;
    return section("Outputs at their worst scenario", table("values", lines), note, described.length ? [page.element("h4", {}, "these scenarios"), table("scenarios", described)] : null);
  };

  const command = (label, text, id) => {
    const said = page.element("span", { class: "copied", role: "status" });
    const copy = async () => {
      said.textContent = (await page.copyText(text)) ? "copied" : "select the text to copy it";
    };
    return page.element("div", { class: "command" }, page.element("div", { class: "muted" }, label), page.element("code", { id, "data-testid": id, tabindex: 0 }, text), page.element("button", { type: "button", class: "no-print", "aria-label": `Copy: ${label}`, click: copy }, "Copy"), said);
  };

  // In local files there may be no clipboard interface; the old way still works in a click.
  page.copyText = async (text) => {
    try {
      await navigator.clipboard.writeText(text);
      return true;
    } catch {
      const area = page.element("textarea", { class: "offscreen" });
      area.value = text;
      document.body.append(area);
      area.select();
      const done = document.execCommand("copy");
      area.remove();
      return done;
    }
  };

  const evaluateOf = (design) => {
    const { evaluate } = page.data;
    // The last one, because a folder may contain the same text.
    const at = evaluate.lastIndexOf("{design}");
    return evaluate.slice(0, at) + design + evaluate.slice(at + "{design}".length);
  };

  const commands = (row) => {
    const { data, front } = page;
    if (!data.evaluate) return null;
    const whole = evaluateOf(page.full(page.designOf(row)));
    const column = front.objectives.map((objective) => objective.column).find((one) => one.scenarios && one.scenarios[row] !== page.noScenario);
    const parts = [command("every output of this design, in f64", whole, "evaluate")];
    if (column) parts.push(command(`in the worst scenario of ${column.name}`, `${whole} --scenario ${column.scenarios[row]}`, "evaluate-scenario"));
    return section("Evaluate again", page.element("p", { class: "hint" }, "Run it in the folder in which this page was made."), parts);
  };

  const button = (id, label, text, click, disabled) => page.element("button", { type: "button", id, "aria-label": label, title: label, click, disabled }, text);
  // The design whose card this is: of another front that came meanwhile it has another row.
  page.pinCard = () => page.pin(page.state.card ?? page.state.known);

  // For cards of designs that are not on the front.
  page.cardParts = { section, table, valueCell, command, evaluateOf, boundsOf, button };

  const named = (row) => [`Design ${page.full(page.designOf(row))}`, row === page.chosenRow() ? page.element("span", { class: "mark" }, ` ${page.chosenWord()}`) : ""];

  const build = (row) => {
    const { front } = page;
    const any = (by) => {
      for (let i = row + by; i >= 0 && i < front.rows; i += by) if (page.mask[i]) return true;
      return false;
    };
    const study = page.element("p", { class: "print-only sheet-study" }, page.data.title);
    const title = page.element("h2", { id: "card-title" }, named(row));
    const place = page.element("p", { class: "muted" }, `row ${page.count(row + 1)} of ${page.count(front.rows)} of the front`, page.mask[row] ? "" : ", not selected");
    const pinned = page.isPinned(row);
    const buttons = page.element("div", { class: "card-buttons no-print" }, button("card-pin", pinned ? "Unpin this design (p)" : "Pin this design, to compare it (p)", pinned ? "Unpin" : "Pin", page.pinCard, !pinned && !page.canPin()), button("card-print", "Print a data sheet of this design", "Print", () => page.printSheet()), button("card-previous", "Previous design (left arrow)", "‹", () => step(-1), !any(-1)), button("card-next", "Next design (right arrow)", "›", () => step(1), !any(1)), button("card-close", "Close (Esc)", "×", page.closeCard));
    return [page.element("div", { class: "card-head" }, page.element("div", {}, study, title, place), buttons), objectives(row), margins(row), page.tradeoffSection(row), page.driveSection(row), inputs(row), outputs(row), page.data.kind === "live" ? page.element("section", { id: "all-outputs" }) : null, commands(row)].filter(Boolean);
  };

  // In a wide window the card takes room from the plots.
  const layoutIfNarrower = (width) => {
    if (page.byId("main").clientWidth !== width) page.events.call("layout");
  };

  // What opened it may have been redrawn in the meantime; then take the new one.
  const returnFocus = () => {
    if (!opener) return;
    const { x, y, focus } = opener.dataset;
    const selector = focus ? `[data-focus="${CSS.escape(focus)}"]` : x ? `.cell[data-x="${CSS.escape(x)}"]${y ? `[data-y="${CSS.escape(y)}"]` : ""}` : opener.id ? `#${CSS.escape(opener.id)}` : null;
    const again = opener.isConnected || !selector ? opener : document.querySelector(selector);
    if (again?.isConnected) again.focus({ preventScroll: true });
  };

  page.openCard = (row, takesFocus = true) => {
    if (!page.front || !(row >= 0 && row < page.front.rows)) return;
    page.showCard(row, () => build(row), takesFocus);
  };

  // A card that waits for its design to be found again cannot be used; who was on it is there again afterwards.
  let heldFocus = null;
  page.holdCard = (isHeld) => {
    const card = page.byId("card");
    if (isHeld && card.contains(document.activeElement)) heldFocus = document.activeElement.id || "card";
    card.inert = isHeld;
    if (isHeld || heldFocus === null) return;
    if (document.activeElement === document.body && !card.hidden) (page.byId(heldFocus) ?? card).focus({ preventScroll: true });
    heldFocus = null;
  };

  let rebuild = null; // what makes the card that is open
  // Of a card below the plots the head stays in sight while the rest is scrolled.
  const fill = (card, [head, ...parts]) => card.replaceChildren(head, page.element("div", { class: "card-body" }, parts));
  const pressed = { is: false, later: false }; // is a button held down on the card, and is it to be built anew then?

  // `known`: the design of the card if it has no row.
  page.showCard = (row, children, takesFocus, known = null) => {
    const card = page.byId("card");
    const fresh = card.hidden;
    const within = card.contains(document.activeElement) ? document.activeElement.id : "";
    if (fresh) opener = document.activeElement;
    const width = page.byId("main").clientWidth;
    Object.assign(page.state, { card: row, known, awaited: null });
    rebuild = children;
    fill(card, children());
    card.hidden = false;
    page.holdCard(false);
    document.body.classList.add("with-card");
    const again = within && page.byId(within);
    if (again && !again.disabled) again.focus();
    else if (takesFocus) card.focus({ preventScroll: true });
    if (fresh) card.scrollTop = 0;
    page.events.call("card");
    if (fresh) layoutIfNarrower(width);
    if (fresh) showViews(card);
  };
  // Below the plots it covers them where the page has not been scrolled to them.
  const showViews = (card) => {
    const [views, place] = [page.byId("views").getBoundingClientRect(), card.getBoundingClientRect()];
    const isBelow = place.left < views.left && place.top > 0 && getComputedStyle(card).position === "fixed";
    if (isBelow && views.top > place.top - Math.min(views.height, 300)) page.byId("views").scrollIntoView({ block: "start" });
  };

  page.closeCard = () => {
    const card = page.byId("card");
    page.state.awaited = null;
    if (card.hidden) return;
    const width = page.byId("main").clientWidth;
    card.hidden = true;
    document.body.classList.remove("with-card");
    Object.assign(page.state, { card: null, known: null });
    page.events.call("card");
    layoutIfNarrower(width);
    returnFocus();
  };

  // Its design is not on the front any more.
  page.closeLostCard = () => {
    const card = page.byId("card");
    const width = page.byId("main").clientWidth;
    const hadFocus = heldFocus !== null || card.contains(document.activeElement);
    heldFocus = null;
    card.hidden = true;
    page.state.known = null;
    document.body.classList.remove("with-card");
    page.events.call("card");
    layoutIfNarrower(width);
    if (hadFocus) returnFocus();
  };

  // The card alone, on paper.
  page.printSheet = () => {
    document.body.classList.add("sheet");
    window.print();
    document.body.classList.remove("sheet");
  };

  page.startCard = () => {
    const card = page.byId("card");
    const again = () => {
      if (card.hidden || (page.state.card === null && !page.state.known)) return;
      // A press on something that is exchanged before it is let go would be lost.
      if (pressed.is) pressed.later = true;
      else if (page.state.card !== null) page.keepFocus(card, () => fill(card, build(page.state.card)));
      else page.keepFocus(card, () => fill(card, rebuild()));
    };
    card.addEventListener("pointerdown", (event) => (pressed.is = event.button === 0));
    const release = () => {
      if (!pressed.is) return;
      // After the click.
      setTimeout(() => {
        pressed.is = false;
        if (pressed.later) again();
        pressed.later = false;
      });
    };
    for (const event of ["pointerup", "pointercancel"]) document.addEventListener(event, release);
    page.events.on("pins.card", again);
    page.events.on("front.card", again);
    page.events.on("choice.card", () => page.state.card !== null && page.byId("card-title").replaceChildren(...named(page.state.card)));
    document.addEventListener("keydown", (event) => {
      if (page.byId("card").hidden || event.defaultPrevented || event.ctrlKey || event.metaKey || event.altKey) return;
      if (event.key === "Escape") page.closeCard();
      else if (page.state.card === null && !page.state.known) return;
      else if (event.key === "p" && card.contains(event.target)) page.byId("card-pin")?.click();
      else if (page.state.card === null) return;
      else if (!page.byId("card").contains(event.target)) return;
      else if (event.target.tagName !== "CODE" && (event.key === "ArrowRight" || event.key === "ArrowLeft")) step(event.key === "ArrowRight" ? 1 : -1);
      else return;
      event.preventDefault();
    });
  };
}
