// Up to six designs that are pinned and compared: what they are made of, and what that gives, differences marked.
{
  const MOST = 6;
  let pins = []; // { design, letter, values: name -> number or text, texts: name -> text, set }
  let awaited = []; // pins of the address that no front had yet: { design, letter, set }

  page.pins = () => pins;
  page.awaitsPins = () => awaited.some((pin) => isOf(pin, askedSet()));
  page.canPin = () => pins.length < MOST;

  const columnsOf = () => page.front.shown.filter((column) => column.role !== "output");

  // What is known of a design is kept with its pin: another front may not have it any more.
  page.pinEntry = (column, value, text) => [column.name, { value, text, unit: column.unit, role: column.role, words: Boolean(column.words), word: column.words ? (column.words[value] ?? text) : null, goal: column.goal }];
  const pinOf = (row) => {
    const entries = page.front.shown.map((column) => page.pinEntry(column, column.values[row], page.valueText(column, row)));
    return { design: page.designOf(row), letter: free(), values: new Map(entries), set: shownSet() };
  };

  const LETTERS = "ABCDEF".split("");
  const isFree = (letter) => !pins.some((pin) => pin.letter === letter);
  const free = () => LETTERS.find((letter) => isFree(letter) && !awaited.some((pin) => pin.letter === letter)) ?? LETTERS.find(isFree);

  // The changes that the shown front is of, and those that are asked for.
  const shownSet = () => page.shownSet ?? [];
  const askedSet = () => (page.changeList ? page.changeList() : []);
  const isOf = (pin, set) => String(pin.set) === String(set);

  // Of a row of the front, or of a design that is known without being on it.
  const pinnedOf = (of) => {
    const { design, set } = typeof of === "number" ? { design: page.designOf(of), set: shownSet() } : of;
    return pins.find((pin) => pin.design === design && isOf(pin, set));
  };
  // Is it of the study that is shown, with the same changes?
  page.isOfShown = (of) => isOf(of, shownSet());
  page.letterOf = (row) => pinnedOf(row)?.letter;
  page.isPinned = (of) => Boolean(pinnedOf(of));

  page.pin = (of) => {
    const pinned = pinnedOf(of);
    return pinned ? page.unpin(pinned) : add(typeof of === "number" ? pinOf(of) : knownPin(of));
  };
  const knownPin = ({ design, set, values }) => ({ design, letter: free(), values, set });

  const add = (pin) => {
    if (!page.canPin()) return;
    pins = [...pins, pin];
    page.say(`design ${pin.design} is pinned as ${pin.letter}, ${pins.length} of ${MOST}`);
    page.events.call("pins");
  };

  page.unpin = (pin) => {
    pins = pins.filter((other) => other !== pin);
    page.say(`design ${pin.design} is no longer pinned`);
    page.events.call("pins");
  };

  // In the address by their designs, with the letter where one before it is missing; those of other changes with these behind a tilde.
  const letterBehind = (pin, i) => (pin.letter === LETTERS[i] ? "" : `@${pin.letter}`);
  const changesOf = (pin) => (isOf(pin, askedSet()) ? "" : `~${pin.set.map(encodeURIComponent).join(";")}`);
  page.pinsText = () => [...pins, ...awaited].map((pin, i) => `${pin.design}${letterBehind(pin, i)}${changesOf(pin)}`).join(",");
  page.readPins = (text) => {
    pins = [];
    // The engine knows every design.
    const isHere = ({ design, set }) => Boolean(page.askPin) || (isOf({ set }, askedSet()) && page.front && (page.rowOf(design) >= 0 || page.knownOf(design)));
    const given = [...new Set((text || "").split(",").filter(Boolean))].map((entry, i) => {
      const [named, changes] = entry.split("~");
      const [design, letter] = named.split("@");
      return { design, letter: LETTERS.includes(letter) ? letter : (LETTERS[i] ?? null), set: changes === undefined ? askedSet() : changes.split(";").filter(Boolean).map(page.decoded) };
    });
    const isFirst = (pin, i) => given.findIndex((other) => other.design === pin.design && isOf(other, pin.set)) === i;
    const wanted = given.filter(isFirst).filter(isHere).slice(0, MOST);
    // An address that somebody wrote may have a letter twice.
    awaited = [];
    for (const pin of wanted) awaited.push({ ...pin, letter: awaited.some((other) => other.letter === pin.letter) || !pin.letter ? free() : pin.letter });
    adoptAwaited();
    page.events.call("pins");
    if (page.askPin) awaited.filter((pin) => !isOf(pin, askedSet())).forEach(askOther);
  };

  // A pin of other changes is on no front that comes: the engine says what it is.
  const askOther = async (pin) => {
    try {
      const values = await page.askPin(pin);
      if (!awaited.includes(pin)) return;
      awaited = awaited.filter((other) => other !== pin);
      if (page.canPin()) pins = [...pins, { ...pin, values, letter: isFree(pin.letter) ? pin.letter : free() }].sort((a, b) => d3.ascending(a.letter, b.letter));
    } catch {
      // Its changes are not the study's any more.
      awaited = awaited.filter((other) => other !== pin);
    }
    page.events.call("pins");
  };

  // A first front has few designs: what it lacks may be on the next.
  const adoptAwaited = () => {
    const isShown = (pin) => page.front && isOf(pin, shownSet());
    const found = awaited.filter((pin) => isShown(pin) && (page.rowOf(pin.design) >= 0 || page.knownOf(pin.design)));
    // Of one that the exact front has not the engine says what it is.
    const isAsked = (pin) => {
      if (!page.askPin) return false;
      if (!pin.isAsked) askOther(Object.assign(pin, { isAsked: true }));
      return true;
    };
    awaited = awaited.filter((pin) => !found.includes(pin) && (page.awaits() || !isShown(pin) || isAsked(pin)));
    for (const { design, letter } of found.slice(0, MOST - pins.length)) {
      const row = page.rowOf(design);
      const pin = row >= 0 ? pinOf(row) : knownPin(page.knownOf(design));
      pins = [...pins, isFree(letter) ? { ...pin, letter } : pin];
    }
    if (found.length) pins.sort((a, b) => d3.ascending(a.letter, b.letter));
  };

  // Of the pinned designs, the best value of an objective.
  const bestOf = (entries) => {
    const goal = entries.find((entry) => entry && entry.goal)?.goal;
    const values = entries.map((entry) => (entry ? entry.value : NaN)).filter(Number.isFinite);
    if (!goal || new Set(values).size < 2) return null;
    return goal === "max" ? Math.max(...values) : Math.min(...values);
  };

  // Words are told by their letters: another front may have others in other places.
  const told = (entry) => (entry ? (entry.word ?? String(entry.value)) : "");

  const line = (name) => {
    const entries = pins.map((pin) => pin.values.get(name));
    const first = entries.find(Boolean);
    const differs = new Set(entries.map(told)).size > 1;
    const best = bestOf(entries);
    const cell = (entry) => {
      if (!entry) return page.element("td", { class: "number muted" }, "–");
      const isBest = best !== null && entry.value === best;
      return page.element("td", { class: `number${isBest ? " best" : ""}`, title: page.full(entry.value) }, entry.text, isBest ? page.element("span", { class: "offscreen" }, " best") : null);
    };
    return page.element("tr", { class: differs ? "differs" : "same" }, page.element("th", { scope: "row" }, page.breakable(name), first.goal ? page.element("span", { class: "unit" }, ` ${first.goal}`) : null), page.element("td", { class: "unit" }, first.words ? "" : page.unit(first.unit)), entries.map(cell));
  };

  const changed = (pin) => (pin.set.length ? page.element("div", { class: "unit", title: pin.set.join("\n") }, `${pin.set.length} change${pin.set.length > 1 ? "s" : ""}`) : null);

  const draw = () => page.keepFocus(page.byId("pins"), build, "#splom [tabindex]");
  const build = () => {
    const section = page.byId("pins");
    section.hidden = !pins.length;
    if (!pins.length) return section.replaceChildren();
    const order = { label: 0, design: 1, objective: 2, constraint: 3, report: 4 };
    const names = new Map();
    for (const pin of pins) for (const [name, entry] of pin.values) if (entry.role in order && !names.has(name)) names.set(name, order[entry.role]);
    const rows = [...names].sort((a, b) => a[1] - b[1]).map(([name]) => name);
    const open = (pin) => {
      const row = isOf(pin, shownSet()) ? page.rowOf(pin.design) : -1;
      return row >= 0 ? page.openCard(row) : page.openKnown(pin);
    };
    const head = (pin) =>
      page.element(
        "th",
        { scope: "col", class: "number" },
        page.element("button", { type: "button", class: "pin-name", "data-focus": `pin ${pin.letter}`, click: () => open(pin), title: "Open its card" }, page.element("span", { class: "pin-letter" }, pin.letter), ` ${pin.design}`),
        page.element("button", { type: "button", class: "back no-print", "data-focus": `unpin ${pin.letter}`, "aria-label": `Unpin design ${pin.design}`, title: "Unpin", click: () => page.unpin(pin) }, "×"),
        changed(pin),
      );
    const same = page.element("input", { type: "checkbox", id: "only-differences", checked: section.dataset.only === "yes", change: (event) => ((section.dataset.only = event.target.checked ? "yes" : "no"), draw()) });
    const shown = section.dataset.only === "yes" ? rows.filter((name) => new Set(pins.map((pin) => told(pin.values.get(name)))).size > 1) : rows;
    section.replaceChildren(
      page.element("div", { class: "title-line" }, page.element("h2", { id: "pins-title" }, "Pinned designs"), page.element("label", { class: "no-print" }, same, " only what differs")),
      page.element("div", { class: "scroll", role: "region", "aria-label": "Pinned designs side by side" }, page.element("table", { class: "pins", "data-testid": "pins-table" }, page.element("thead", {}, page.element("tr", {}, page.element("th", { scope: "col" }, "quantity"), page.element("th", { scope: "col" }, "unit"), pins.map(head))), page.element("tbody", {}, shown.map(line)))),
      pins.length === 1 ? page.element("p", { class: "hint no-print" }, "Pin another design, from its card, to compare them.") : "",
    );
    page.oneStop(section, "thead button");
  };

  page.startPins = () => {
    page.events.on("pins.table", draw);
    page.events.on("front.pins", () => {
      // The values of a pin of this very study are those of the newest answer, which may know more.
      pins = pins.map((pin) => {
        const row = isOf(pin, shownSet()) ? page.rowOf(pin.design) : -1;
        return row < 0 ? pin : { ...pinOf(row), letter: pin.letter };
      });
      const count = awaited.length;
      adoptAwaited();
      if (awaited.length === count) draw();
      else page.events.call("pins");
    });
    draw();
  };
}
