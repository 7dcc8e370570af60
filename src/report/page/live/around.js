// What is around a design, asked of the engine: slices, and on the card every output.
{
  let asking = null;

  const ask = async () => {
    const section = page.byId("around");
    // Of other changes only what is on the card is known.
    const known = page.state.known && page.isOfShown(page.state.known) ? page.state.known : null;
    const row = page.state.card ?? (page.front ? page.chosenRow() : null);
    if (asking) asking.abort();
    if (page.state.awaited !== null) return null;
    if (!known && (row === null || row === undefined)) return (section.hidden = true);
    section.hidden = false;
    const design = known ? known.design : page.designOf(row);
    const title = `Around design ${design}${page.state.card === null && !known ? ` (${page.chosenWord()})` : ""}`;
    const box = section.querySelector(".around-box") || page.element("div", { class: "around-box" });
    // A box that stays where it is keeps the focus.
    if (box.isConnected) page.byId("around-title").replaceChildren(title);
    else section.replaceChildren(page.element("h2", { id: "around-title" }, title), box);
    if (!box.hasChildNodes()) box.append(page.element("p", { class: "hint" }, "being computed"));
    asking = new AbortController();
    try {
      page.drawSlices(box, await page.askOnce("/around", { set: page.changeList(), design }, asking.signal));
      page.timings.around = performance.now();
    } catch (error) {
      if (error.name !== "AbortError") box.replaceChildren(page.element("p", { class: "notice" }, error.message));
    }
    return null;
  };

  // All outputs of the design of the card.
  const askOutputs = async () => {
    const of = () => page.state.card ?? page.state.known;
    const asked = of();
    const box = page.byId("all-outputs");
    if (asked === null || !box) return;
    const design = page.numberOfDesign(asked);
    // What is shown may be of the study before a change.
    const set = asked.set ?? page.shownSet;
    try {
      const told = await page.askOnce("/design", { set, design });
      if (of() === null || page.numberOfDesign(of()) !== design || (of().set ?? page.shownSet) !== set || !page.byId("all-outputs")) return;
      page.knowMore(of(), told);
      const known = new Set(asked.values ? asked.values.keys() : page.front.shown.map((column) => column.name));
      const lines = told.outputs.filter((output) => !known.has(output.name)).map((output) =>
        page.element("tr", {}, page.element("th", { scope: "row", title: output.doc }, page.breakable(output.name)), page.element("td", { class: "number" }, page.element("span", { "data-name": output.name, "data-value": page.full(output.value), title: page.full(output.value) }, page.short(output.value)), page.element("span", { class: "unit" }, output.value === null ? "" : ` ${page.unit(output.unit)}`)), page.element("td", { class: "scenario" }, output.scenario === null ? "" : `#${output.scenario}`)),
      );
      page.byId("all-outputs").replaceChildren(page.element("h3", {}, "All other outputs"), page.element("table", { class: "values" }, page.element("tbody", {}, lines)));
    } catch (error) {
      box.replaceChildren(page.element("p", { class: "notice" }, error.message));
    }
  };

  // What any design is made of with these changes, what that gives, and what its drawing needs.
  const askKnown = async ({ design, set }) => {
    const told = await page.askOnce("/design", { set, design });
    const values = new Map([...Object.entries(told.inputs), ...told.outputs.map(({ name, value }) => [name, value ?? NaN])]);
    const entry = (column) => {
      const value = values.get(column.name);
      return page.pinEntry(column, column.words ? column.words.indexOf(String(value)) : value, page.short(value));
    };
    const shown = new Map(page.front.shown.filter((column) => values.has(column.name)).map(entry));
    return { design, set, values: shown, isFeasible: told.feasible, status: told.status, section: told.section, givens: told.givens, inputs: told.described };
  };
  page.askPin = async (pin) => (await askKnown(pin)).values;

  // The card of a design that the exact front has not, or no more, stays: with what it is now, and why it is not there.
  page.keepLost = async (design, set) => {
    const { known: shown } = page.state;
    // The certified front has not got it either.
    if (shown && shown.design === design && String(shown.set) === String(set)) return;
    Object.assign(page.state, { card: null, awaited: design });
    page.holdCard(true);
    const isOld = () => page.state.awaited !== design || String(page.shownSet) !== String(set);
    try {
      const known = await askKnown({ design, set });
      if (!isOld()) page.openKnown(known, false);
    } catch {
      // There is no such design in the study as it is now.
      if (isOld()) return;
      page.state.awaited = null;
      page.closeLostCard();
      page.holdCard(false);
    }
  };

  page.startAround = () => {
    let waiting = 0;
    const later = (wait) => {
      clearTimeout(waiting);
      // The front comes first.
      waiting = setTimeout(() => (page.isAnswered() ? ask() : later(wait)), wait);
    };
    // The card is drawn anew with another front and with each pin: its list of outputs too.
    let outputs = 0;
    const laterOutputs = (wait) => {
      clearTimeout(outputs);
      outputs = setTimeout(askOutputs, wait);
    };
    // What was around the design before a change keeps nobody waiting.
    page.events.on("changes.around", () => {
      if (asking) asking.abort();
      later(500);
    });
    page.events.on("front.around", () => {
      later(500);
      laterOutputs(500);
    });
    page.events.on("choice.around", () => later(60));
    page.events.on("pins.around", () => laterOutputs(0));
    page.events.on("card.around", () => {
      later(60);
      laterOutputs(0);
    });
    later(300);
  };
}
