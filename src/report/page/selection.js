// The state of the page: which columns are shown, what is brushed, the colour column, the current point.
// Every view changes it through these functions only, and draws it.
{
  // Axes of the parallel plot, at most.
  const MOST_AXES = 14;
  const state = {
    matrix: [], // names of the scatter matrix' columns
    parallel: [], // names of the axes, in order
    leftOut: [], // names of inputs that were constant on every front so far, and so are no axes yet
    inverted: new Set(),
    colour: null,
    axes: new Map(), // name -> [low, high]
    cells: new Map(), // "x*y" -> { x, y, xRange, yRange }
    current: null, // row under the pointer or reached by the arrow keys
    card: null, // row of the open card
    known: null, // the design of the open card if it is not on the front, see known.js
    awaited: null, // design whose card opens, or is shown anew, once a front has it
    theme: null, // "light", "dark" or null: as the system says
    columns: "", // names of all columns, to know another study by
  };
  const orders = new Map();
  page.state = state;
  page.mask = new Uint8Array(0);
  page.selectedCount = 0;

  page.startState = () => {
    const { front } = page;
    const names = (columns) => columns.map((column) => column.name);
    const objectives = [...new Set(front.objectives.map((objective) => objective.column.name))];
    state.matrix = objectives.slice(0, 6);
    const inputs = front.shown.filter((column) => column.role === "design");
    // Inputs that are constant on the front make useless axes; they are only in the chooser.
    const varied = inputs.filter((column) => !(column.low === column.high) || front.rows < 2);
    state.leftOut = names(inputs.filter((column) => !varied.includes(column)));
    const judged = front.shown.filter((column) => ["objective", "constraint", "report"].includes(column.role));
    // Where rows of a catalogue have labels, these say what the design is; the numbers of the row come after all else.
    const labels = front.shown.filter((column) => column.role === "label" && page.isCategory(column) && column.low < column.high);
    const ofRow = new Set((page.data.inputs || []).filter((input) => input.labelled).map((input) => input.name));
    const [last, first] = [true, false].map((is) => varied.filter((column) => ofRow.has(column.name) === is));
    state.parallel = [...new Set([...names(labels), ...names(first), ...names(judged), ...names(last)])].slice(0, MOST_AXES);
    state.inverted = new Set();
    // Categories are what a colour tells best; without one, the first objective, which sorts the front.
    const category = front.shown.find((column) => ["design", "label"].includes(column.role) && page.isCategory(column) && column.low < column.high);
    state.colour = category?.name ?? objectives[0] ?? state.parallel[0] ?? null;
    state.axes = new Map();
    state.cells = new Map();
    page.mask = new Uint8Array(front.rows).fill(1);
    page.selectedCount = front.rows;
  };

  // The axes that stay, and inputs that vary now for the first time: in their usual places, unless the user has put the axes in another order.
  const withNewAxes = (kept, leftOut) => {
    const isNew = (name) => leftOut.includes(name) && !kept.includes(name);
    const usual = state.parallel.filter((name) => kept.includes(name) || isNew(name));
    const isUsual = usual.filter((name) => kept.includes(name)).join() === kept.join();
    return (isUsual ? usual : [...kept, ...usual.filter(isNew)]).slice(0, MOST_AXES);
  };

  // Another front is there: what is chosen and brushed stays, as far as it has such columns.
  page.adoptFront = () => {
    const { front } = page;
    orders.clear();
    const known = (name) => front.byName.has(name);
    const kept = { matrix: state.matrix.filter(known), parallel: state.parallel.filter(known), inverted: state.inverted, colour: state.colour, axes: state.axes, cells: state.cells };
    const columns = front.columns.map((column) => column.name).join();
    const isSame = columns === state.columns;
    const { leftOut } = state;
    page.startState();
    state.columns = columns;
    if (isSame) {
      const parallel = withNewAxes(kept.parallel, leftOut);
      Object.assign(state, { matrix: kept.matrix, parallel, colour: known(kept.colour) ? kept.colour : state.colour });
      state.leftOut = state.leftOut.filter((name) => leftOut.includes(name));
    }
    state.inverted = kept.inverted;
    for (const [name, range] of kept.axes) if (known(name) && state.parallel.concat(state.matrix).includes(name)) state.axes.set(name, range);
    for (const [key, cell] of kept.cells) if (state.matrix.includes(cell.x) && state.matrix.includes(cell.y)) state.cells.set(key, cell);
    state.current = null;
    count();
  };

  const keep = (values, [low, high]) => {
    const { mask } = page;
    for (let i = 0; i < mask.length; i++) if (!(values[i] >= low && values[i] <= high)) mask[i] = 0;
  };

  const count = () => {
    const { mask, front } = page;
    mask.fill(1);
    for (const [name, range] of state.axes) keep(front.byName.get(name).values, range);
    for (const { x, y, xRange, yRange } of state.cells.values()) {
      keep(front.byName.get(x).values, xRange);
      keep(front.byName.get(y).values, yRange);
    }
    let selected = 0;
    for (let i = 0; i < mask.length; i++) selected += mask[i];
    page.selectedCount = selected;
  };

  const apply = () => {
    count();
    page.events.call("selection");
  };
  page.applySelection = apply;

  // The bounds of the constraints on a column.
  page.limitsOf = (column) => {
    const bounds = page.front.constraints.filter((it) => it.column?.name === column.name).flatMap(({ min, above, max, below }) => [min, above, max, below]);
    return bounds.filter((it) => it !== null && it !== undefined);
  };

  // The range in which an input was searched; null for all else.
  page.searchedOf = (column) => {
    const input = column.role === "design" && !column.words ? (page.data.inputs || []).find((it) => it.name === column.name) : null;
    return input && Number.isFinite(input.least) && Number.isFinite(input.largest) && input.least < input.largest ? [input.least, input.largest] : null;
  };

  // Which end of its axis a design stands on: "lower", "upper" or "".
  page.endOf = (column, row) => {
    const input = column.role === "design" && (page.data.inputs || []).find((it) => it.name === column.name);
    if (!input || !Number.isFinite(input.least) || input.least === input.largest) return "";
    const value = column.values[row];
    return value === input.least ? "lower" : value === input.largest ? "upper" : "";
  };

  // Is the front of the designs in this range the front in this range? Only where it cuts an objective on its worse side: elsewhere designs
  // that are beaten now would be on it.
  page.isOfFront = (name, [low, high]) => {
    const column = page.front.byName.get(name);
    return Boolean(column.goal) && (column.goal === "min" ? low <= column.low : high >= column.high);
  };

  page.brushed = () => state.axes.size + state.cells.size > 0;

  page.brushAxis = (name, range) => {
    if (range) state.axes.set(name, range);
    else if (!state.axes.delete(name)) return;
    apply();
  };

  page.brushCell = (x, y, xRange, yRange) => {
    if (xRange) state.cells.set(`${x}*${y}`, { x, y, xRange, yRange });
    else if (!state.cells.delete(`${x}*${y}`)) return;
    apply();
  };

  page.clearBrushes = () => {
    state.axes.clear();
    state.cells.clear();
    apply();
  };

  page.selected = () => {
    const rows = [];
    for (let i = 0; i < page.mask.length; i++) if (page.mask[i]) rows.push(i);
    return rows;
  };

  // A brush that is no longer shown would select invisibly: it is removed with its axis or cell.
  page.chooseColumns = (which, names) => {
    state[which] = names;
    // What was an axis once is the user's to bring back.
    if (which === "parallel") state.leftOut = state.leftOut.filter((name) => !names.includes(name));
    const gone = (name) => !state.parallel.includes(name);
    let changed = false;
    for (const name of state.axes.keys()) if (gone(name)) changed = state.axes.delete(name) || changed;
    for (const [key, { x, y }] of state.cells) {
      const shown = state.matrix.includes(x) && state.matrix.indexOf(x) < state.matrix.indexOf(y);
      if (!shown) changed = state.cells.delete(key) || changed;
    }
    page.events.call("columns");
    if (changed) apply();
  };

  page.moveAxis = (name, to) => {
    const order = state.parallel.filter((other) => other !== name);
    order.splice(Math.max(0, Math.min(to, order.length)), 0, name);
    state.parallel = order;
    page.events.call("columns", null, "order");
  };

  page.invertAxis = (name) => {
    if (!state.inverted.delete(name)) state.inverted.add(name);
    page.events.call("columns", null, "order");
  };

  page.setColour = (name) => {
    state.colour = name;
    page.events.call("colour");
  };

  page.setCurrent = (row) => {
    if (row === state.current) return;
    state.current = row;
    page.events.call("current");
  };

  // The next selected row in the order of a column, for the arrow keys.
  page.nextInOrder = (name, row, step) => {
    if (!orders.has(name)) {
      const { values } = page.front.byName.get(name);
      const order = Uint32Array.from(values.keys()).filter((i) => !Number.isNaN(values[i]));
      order.sort((a, b) => values[a] - values[b] || a - b);
      const place = new Int32Array(values.length).fill(-1);
      order.forEach((i, at) => (place[i] = at));
      orders.set(name, { order, place });
    }
    const { order, place } = orders.get(name);
    let at = row === null ? (step > 0 ? -1 : order.length) : place[row];
    for (at += step; at >= 0 && at < order.length; at += step) if (page.mask[order[at]]) return order[at];
    return row;
  };

  // Ends of a brush are rounded to a tenth of a pixel, so that the address has short numbers that select the same.
  page.roundRange = (a, b, pixels, domain) => {
    const step = 10 ** Math.floor(Math.log10(Math.abs(domain[1] - domain[0]) / pixels / 2));
    const round = (value) => Number((Math.round(value / step) * step).toPrecision(12));
    return [round(Math.min(a, b)), round(Math.max(a, b))];
  };
}
