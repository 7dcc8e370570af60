// How stable the first place is: of many sets of weights, in how many which design comes first. The same sets each time, by a seed.
{
  const SETS = 1000;
  const SEED = 22;
  const SLICE = 10; // ms

  // Random numbers from 0 to 1 (mulberry32).
  page.random = (seed) => () => {
    seed = (seed + 0x6d2b79f5) | 0;
    let mixed = Math.imul(seed ^ (seed >>> 15), 1 | seed);
    mixed = (mixed + Math.imul(mixed ^ (mixed >>> 7), 61 | mixed)) ^ mixed;
    return ((mixed ^ (mixed >>> 14)) >>> 0) / 4294967296;
  };

  // "near": each weight times a factor of its own from 0.8 to 1.2. "any": all weights that there are, each set as likely as any other.
  const setsOf = (kind, shares) => {
    const random = page.random(SEED);
    return Array.from({ length: SETS }, () => {
      if (kind === "near") return shares.map((share) => share * (0.8 + 0.4 * random()));
      const parts = shares.map(() => -Math.log(1 - random()));
      const sum = d3.sum(parts);
      return parts.map((part) => part / sum);
    });
  };

  // Designs that can come first with some set: those whose least score is not above the least of all largest scores.
  const candidates = ({ short }, sets) => {
    const ends = short.map((_, j) => d3.extent(sets, (set) => set[j]));
    const rows = short[0].length;
    const [low, high] = [new Float64Array(rows), new Float64Array(rows)];
    let bar = Infinity;
    for (let row = 0; row < rows; row++) {
      let [least, most, sum] = [-Infinity, -Infinity, 0];
      for (let j = 0; j < short.length; j++) {
        const by = short[j][row];
        sum += by;
        if (ends[j][1] === 0) continue;
        least = Math.max(least, by * ends[j][by > 0 ? 0 : 1]);
        most = Math.max(most, by * ends[j][by > 0 ? 1 : 0]);
      }
      low[row] = least + page.sumShare * sum;
      high[row] = most + page.sumShare * sum;
      if (high[row] < bar) bar = high[row];
    }
    const kept = [];
    for (let row = 0; row < rows; row++) if (low[row] <= bar) kept.push(row);
    return kept;
  };

  // Counts in slices, so that the page stays quick; ends early once `isOld` says that nobody waits for it. Rows with their counts.
  page.stability = async (kind, isOld) => {
    const ranking = page.ranking();
    const sets = setsOf(kind, ranking.shares);
    const rows = candidates(ranking, sets);
    const wins = new Map();
    let from = performance.now();
    for (const set of sets) {
      let first = rows[0];
      let least = Infinity;
      for (const row of rows) {
        const score = page.scoreOf(ranking.short, set, row);
        if (score < least) [least, first] = [score, row];
      }
      wins.set(first, (wins.get(first) || 0) + 1);
      if (performance.now() - from < SLICE) continue;
      await new Promise((done) => setTimeout(done));
      if (isOld()) return null;
      from = performance.now();
    }
    return { sets: SETS, seed: SEED, wins };
  };
}
