// Which design axis explains how much of a quantity over the feasible designs: first-order shares of the variance, from a sample.
//
// The share of an axis is that of the variance between its levels, corrected for what so many levels would explain by chance (Kelley's
// epsilon squared): 1 - (n - 1) / (n - levels) * (within / all). Where a level has fewer than ten designs in the mean, neighbouring ones are put together.
{
  const RESAMPLES = 200;
  const SEED = 22;
  const EACH = 10; // designs of a level, in the mean
  const MOST = 20; // groups of an axis
  const SLICE = 10; // ms
  const FEWEST = 40; // designs of a sample

  page.fewestFeasible = FEWEST;

  // The group of each design by its level; null if the axis has one level, and none if it has too many that have no order.
  const groupsOf = ({ values, ordered }) => {
    const counts = d3.rollup(values, (same) => same.length, (it) => it);
    const levels = [...counts.keys()].sort((a, b) => a - b);
    if (levels.length < 2) return null;
    const few = values.length / levels.length < EACH;
    if (few && !ordered) return { count: 0, filled: 0, of: null, levels: levels.length };
    const groupOf = new Map();
    let count = 0;
    let filled = 0;
    const wanted = few ? values.length / Math.min(MOST, Math.floor(values.length / EACH)) : 0;
    for (const level of levels) {
      groupOf.set(level, count);
      filled += counts.get(level);
      // Counted from the start, so that what one group has too much the next has less.
      if (filled >= wanted * (count + 1)) count = few ? Math.floor(filled / wanted) : count + 1;
    }
    const of = Uint32Array.from(values, (value) => groupOf.get(value));
    return { count: d3.max(of) + 1, filled: new Set(of).size, of, levels: levels.length };
  };

  // The share of one axis; `times` says how often each design counts.
  const shareOf = (values, { of, count }, times) => {
    const [sums, numbers] = [new Float64Array(count), new Float64Array(count)];
    let [n, sum, squares] = [0, 0, 0];
    for (let i = 0; i < values.length; i++) {
      const value = values[i];
      const often = times ? times[i] : 1;
      if (often === 0 || value !== value) continue;
      n += often;
      sum += often * value;
      squares += often * value * value;
      sums[of[i]] += often * value;
      numbers[of[i]] += often;
    }
    let [between, filled] = [0, 0];
    for (let group = 0; group < count; group++) {
      if (numbers[group] === 0) continue;
      filled++;
      between += (sums[group] * sums[group]) / numbers[group];
    }
    const all = squares - (sum * sum) / n;
    if (!(all > 1e-12 * squares) || n <= filled) return NaN;
    return 1 - (((squares - between) / (n - filled)) * (n - 1)) / all;
  };

  // Values with their mean taken away, so that squares of them lose no digits.
  const centred = (values) => {
    const mean = d3.mean(values, (value) => (Number.isFinite(value) ? value : NaN)) || 0;
    return Float64Array.from(values, (value) => (Number.isFinite(value) ? value - mean : NaN));
  };

  // Axes, and for every column the share of each with half the width of its interval of 95 %; null once nobody waits for it.
  page.importance = async (sample, isOld) => {
    const axes = sample.axes.map((axis) => ({ name: axis.name, of: axis.levels, groups: groupsOf(axis) })).filter(({ groups }) => groups);
    const columns = [...sample.byName].map(([name, column]) => ({ name, unit: column.unit, values: centred(column.values) }));
    const each = (times) => columns.map(({ values }) => axes.map(({ groups }) => (groups.count ? shareOf(values, groups, times) : NaN)));
    const shares = each(null);
    const random = page.random(SEED);
    const drawn = [];
    let from = performance.now();
    for (let round = 0; round < RESAMPLES; round++) {
      const times = new Uint16Array(sample.rows);
      for (let i = 0; i < sample.rows; i++) times[Math.floor(random() * sample.rows)]++;
      drawn.push(each(times));
      if (performance.now() - from < SLICE) continue;
      await new Promise((done) => setTimeout(done));
      if (isOld()) return null;
      from = performance.now();
    }
    const half = (column, axis) => 1.96 * (d3.deviation(drawn, (round) => round[column][axis]) ?? 0);
    return {
      axes: axes.map(({ name, of, groups }) => ({ name, of, levels: groups.levels, groups: groups.filled })),
      columns: columns.map(({ name, unit }, c) => ({ name, unit, shares: shares[c].map((share, a) => ({ share, half: half(c, a) })) })).filter(({ shares: own }) => own.some(({ share }) => !Number.isNaN(share))),
      resamples: RESAMPLES,
      seed: SEED,
    };
  };
}
