// Unpacks the data: base64, zlib, then columns of numbers one after the other.
{
  const bytesOf = (text) => {
    if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
    const raw = atob(text);
    const bytes = new Uint8Array(raw.length);
    for (let i = 0; i < raw.length; i++) bytes[i] = raw.charCodeAt(i);
    return bytes;
  };

  page.inflate = (text) => {
    const stream = new Blob([bytesOf(text)]).stream().pipeThrough(new DecompressionStream("deflate"));
    return new Response(stream).arrayBuffer();
  };

  const ABSENT = 0xffffffff;
  page.noScenario = ABSENT;

  const widthOf = (type) => (type === "f64" || type === "u64" ? 8 : 4);

  // Whole-number columns become f64 too, so that an absent value is NaN everywhere.
  const readValues = (buffer, offset, rows, type) => {
    const part = buffer.slice(offset, offset + rows * widthOf(type)); // a copy: columns need not be aligned
    if (type === "f64") return new Float64Array(part);
    if (type === "f32") return new Float32Array(part);
    if (type === "u64") return Float64Array.from(new BigUint64Array(part), Number);
    return Float64Array.from(new Uint32Array(part), (value) => (value === ABSENT ? NaN : value));
  };

  page.withRange = (column) => {
    column.whole = column.values.every((value) => !Number.isFinite(value) || Number.isInteger(value));
    let low = Infinity;
    let high = -Infinity;
    let finite = 0;
    for (const value of column.values) {
      if (!Number.isFinite(value)) continue;
      finite++;
      if (value < low) low = value;
      if (value > high) high = value;
    }
    column.low = finite ? low : NaN;
    column.high = finite ? high : NaN;
    column.absent = column.values.length - finite;
    return column;
  };

  // The values, the range in which an input was searched, and limits that are not far from the values.
  const NEAR = 0.5; // of the span of the values
  const endsOf = ({ low, high, ...column }) => {
    const searched = page.searchedOf(column) || [];
    const near = page.limitsOf(column).filter((it) => it >= low - NEAR * (high - low) && it <= high + NEAR * (high - low));
    return [Math.min(low, ...searched, ...near), Math.max(high, ...searched, ...near)];
  };

  // What an axis spans: a little more than that; a constant column gets a range around it.
  page.domain = (column) => {
    if (column.words) return [-0.5, column.words.length - 0.5];
    if (Number.isNaN(column.low)) return [0, 1];
    const [low, high] = endsOf(column);
    if (low !== column.low || high !== column.high) return [low - (high - low) * 0.04, high + (high - low) * 0.04];
    const span = column.high - column.low;
    if (!(span > Math.abs(column.high) * 1e-12)) {
      const around = Math.abs(column.low) * 0.05 || 1;
      return [column.low - around, column.low + around];
    }
    return [column.low - span * 0.04, column.high + span * 0.04];
  };

  // A column as the text of one value: a word or a number.
  page.valueText = (column, row, text = page.short) => {
    const value = column.values[row];
    // With every digit a word is as the file has it.
    if (column.words) return value in column.words ? (text === page.full ? column.words[value] : page.wordText(column.words[value])) : text(NaN);
    if (column.exact) return column.exact[row];
    return text(value, column.type);
  };

  // How many bytes the numbers of a front take.
  page.packedBytes = ({ columns, rows }) => d3.sum(columns, ({ type, scenario }) => rows * (widthOf(type) + (scenario ? 4 : 0)));

  const decodeFront = (front, buffer) => {
    const columns = [];
    const byName = new Map();
    let offset = 0;
    for (const stored of front.columns) {
      const column = { ...stored, scenarios: null };
      column.values = readValues(buffer, offset, front.rows, stored.type);
      // An f64 does not hold every digit of an index: what is shown and compared is its text.
      if (stored.type === "u64") column.exact = Array.from(new BigUint64Array(buffer.slice(offset, offset + front.rows * 8)), String);
      offset += front.rows * widthOf(stored.type);
      if (stored.scenario) {
        column.scenarios = new Uint32Array(buffer.slice(offset, offset + front.rows * 4));
        offset += front.rows * 4;
      }
      page.withRange(column);
      byName.set(column.name, column);
      columns.push(column);
    }
    return { ...front, columns, byName };
  };

  // A sample of the feasible designs: values by the names of columns, which have their range, and axes with the place of each design.
  page.sampleOf = (sample, buffer) => {
    const byName = new Map();
    let offset = 0;
    const next = ({ type, ...told }) => {
      const column = { ...told, values: readValues(buffer, offset, sample.rows, type) };
      offset += sample.rows * widthOf(type);
      return column;
    };
    for (const column of sample.columns) byName.set(column.name, page.withRange(next(column)));
    return { ...sample, byName, axes: sample.axes.map(next) };
  };

  // What an axis of the scatter matrix spans: the front with the sample, the old front and other results behind it.
  page.ghost = null;
  page.wideDomain = (column) => {
    // The sample of a study in work comes and goes: the axes stay where they are.
    const sample = page.data.kind === "live" ? null : page.sample;
    const behind = [sample, page.ghost, ...page.others].map((layer) => layer && layer.byName.get(column.name)).filter((it) => it && !Number.isNaN(it.low));
    if (!behind.length || column.words || Number.isNaN(column.low)) return page.domain(column);
    return page.domain({ ...column, low: Math.min(column.low, ...behind.map((it) => it.low)), high: Math.max(column.high, ...behind.map((it) => it.high)) });
  };

  // A front out of its description and its numbers. `data` says which columns are objectives and constraints.
  page.frontOf = (data, stored, buffer) => {
    const front = decodeFront(stored, buffer);
    front.objectives = (data.objectives || []).map((objective) => ({ ...objective, column: front.columns[objective.column] }));
    front.constraints = (data.constraints || []).map((bound) => ({ ...bound, column: front.columns[bound.column] }));
    for (const { column, goal } of front.objectives) column.goal = goal;
    front.index = front.columns.find((column) => column.role === "index");
    front.shown = front.columns.filter((column) => column !== front.index);
    return front;
  };

  page.decode = async () => {
    const data = JSON.parse(page.byId("data").textContent);
    page.data = data;
    if (!data.front) return;
    page.front = page.frontOf(data, data.front, data.front.rows ? await page.inflate(data.front.packed) : new ArrayBuffer(0));
    page.sample = data.sample ? page.sampleOf(data.sample, data.sample.rows ? await page.inflate(data.sample.packed) : new ArrayBuffer(0)) : null;
    page.feasible = page.sample;
    page.timings.decoded = performance.now();
  };

  page.designOf = (row) => String(page.front.index ? page.front.index.exact[row] : row);
  page.rowOf = (design) => (page.front.index ? page.front.index.exact.indexOf(design) : -1);
}
