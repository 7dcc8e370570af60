// The state of the page, written after "#" in the address, so that a view can be bookmarked or sent to somebody.
//   c=columns of the matrix   pc=axes in order   inv=reversed axes      col=colour column
//   p=pinned designs, @letter behind some         s=changes of a live study
//   w=objective:weight,...   a=objective:wished value,...              wn=weight sets that places are tried with
//   b=axis:low..high,...      r=x*y:low..high*low..high,...             d=open design   t=light|dark
{
  const encode = (name) => encodeURIComponent(name).replace(/\*/g, "%2A");
  const range = ([low, high]) => `${low}..${high}`;
  let defaults = { matrix: "", parallel: "", colour: null };
  let written = null;

  page.writeAddress = () => {
    const text = page.viewText();
    const hash = text ? `#${text}` : "";
    if (hash === location.hash || hash === written) return;
    written = hash;
    // Some browsers refuse to change the address of a local file: then the state is not kept.
    try {
      history.replaceState(null, "", hash || location.pathname + location.search);
    } catch {
      return;
    }
  };

  page.viewText = () => {
    const { state } = page;
    const parts = [];
    const add = (key, text) => text && parts.push(`${key}=${text}`);
    if (page.front) {
      const list = (names) => names.map(encode).join(",");
      if (list(state.matrix) !== defaults.matrix) parts.push(`c=${list(state.matrix)}`);
      add("b", [...state.axes].map(([name, ends]) => `${encode(name)}:${range(ends)}`).join(","));
      add("r", [...state.cells.values()].map((cell) => `${encode(cell.x)}*${encode(cell.y)}:${range(cell.xRange)}*${range(cell.yRange)}`).join(","));
      if (list(state.parallel) !== defaults.parallel) parts.push(`pc=${list(state.parallel)}`);
      add("inv", list([...state.inverted]));
      if (state.colour !== defaults.colour) add("col", encode(state.colour ?? ""));
      const known = state.known && String(state.known.set) === String(page.changeList ? page.changeList() : []) ? state.known.design : null;
      add("d", state.card !== null ? page.designOf(state.card) : (known ?? state.awaited));
    }
    add("t", state.theme);
    if (page.front) {
      add("p", page.pinsText());
      add("w", page.weightsText());
      add("a", page.wishesText());
      add("wn", page.nearText());
    }
    if (page.changesText) add("s", page.changesText());
    return parts.join("&");
  };

  const parseRange = (text) => {
    const ends = (text || "").split("..").map(Number);
    const good = ends.length === 2 && ends.every(Number.isFinite) && text.length > 3;
    return good ? ends.sort((a, b) => a - b) : null;
  };

  page.decoded = (text) => {
    try {
      return decodeURIComponent(text);
    } catch {
      return "";
    }
  };

  // Whatever the page does not know, such as a column of another study, is ignored. What opens the card of the address, once the views are
  // there; null without one.
  page.readAddress = () => {
    const { state, front } = page;
    const given = new Map(location.hash.slice(1).split("&").map((part) => [part.slice(0, part.indexOf("=")), part.slice(part.indexOf("=") + 1)]));
    const theme = given.get("t");
    state.theme = theme === "light" || theme === "dark" ? theme : null;
    if (!front) return null;
    const known = (name) => front.byName.has(name) && front.byName.get(name) !== front.index;
    const list = (key) => (given.has(key) ? [...new Set(given.get(key).split(",").map(page.decoded).filter(known))] : null);
    page.startState();
    defaults = { matrix: state.matrix.map(encode).join(","), parallel: state.parallel.map(encode).join(","), colour: state.colour };
    const matrix = list("c");
    if (matrix && matrix.length) state.matrix = matrix.slice(0, 8);
    const parallel = list("pc");
    if (parallel && parallel.length) state.parallel = parallel;
    state.inverted = new Set(list("inv") || []);
    const colour = page.decoded(given.get("col") || "");
    if (known(colour)) state.colour = colour;
    for (const part of (given.get("b") || "").split(",")) {
      const [name, ends] = part.split(":");
      const range = parseRange(ends);
      const shown = known(page.decoded(name)) && (state.parallel.includes(page.decoded(name)) || state.matrix.includes(page.decoded(name)));
      if (range && shown) state.axes.set(page.decoded(name), range);
    }
    for (const part of (given.get("r") || "").split(",")) {
      const [names, ends] = part.split(":");
      const [x, y] = names.split("*").map(page.decoded);
      const [xRange, yRange] = (ends || "").split("*").map(parseRange);
      const places = [state.matrix.indexOf(x), state.matrix.indexOf(y)];
      if (xRange && yRange && places[0] >= 0 && places[0] < places[1]) state.cells.set(`${x}*${y}`, { x, y, xRange, yRange });
    }
    page.readPins(given.get("p"));
    page.readNear(given.get("wn"));
    page.readWeights(given.get("w"), given.get("a"));
    const design = given.get("d") ?? "";
    const row = page.rowOf(design);
    state.awaited = row < 0 && page.awaits() ? design || null : null;
    if (row >= 0) return () => page.openCard(row);
    if (design && page.keepLost && state.awaited === null) return () => page.keepLost(design, page.changeList());
    const elsewhere = state.awaited === null ? page.knownOf(design) : null;
    return elsewhere && (() => page.openKnown(elsewhere));
  };

  page.startAddress = () => {
    // After a pause: browsers limit how often the address may change.
    let waiting = 0;
    const write = () => {
      clearTimeout(waiting);
      waiting = setTimeout(page.writeAddress, 150);
    };
    for (const event of ["selection", "columns", "colour", "card", "theme", "changes", "pins", "choice"]) page.events.on(`${event}.address`, write);
    window.addEventListener("hashchange", () => {
      if (location.hash === written) return;
      written = location.hash;
      // Before the designs: they are those of the changed study.
      if (page.readChanges) page.readChanges();
      const open = page.readAddress();
      page.applyTheme();
      if (!page.front) return;
      page.events.call("columns");
      page.events.call("colour");
      page.applySelection();
      if (open) return open();
      const { awaited } = page.state;
      page.closeCard();
      page.state.awaited = awaited;
    });
  };
}
