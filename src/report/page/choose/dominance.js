// How many designs of one front are beaten by one of another: it is no worse in any objective and better in one.
{
  const SLICE = 10; // ms

  // Objectives as numbers of which less is better, the rows with the least sums first: who beats another has no larger sum.
  const pointsOf = (goals, byName, rows) => {
    const values = goals.map(({ name, goal, column }) => {
      const span = column.high - column.low || 1;
      const sign = goal === "max" ? -1 : 1;
      return Float64Array.from(byName.get(name).values, (value) => (sign * value) / span);
    });
    const whole = d3.range(rows).filter((row) => values.every((it) => Number.isFinite(it[row])));
    const sums = new Float64Array(rows);
    for (const row of whole) for (const it of values) sums[row] += it[row];
    whole.sort((a, b) => sums[a] - sums[b]);
    return { values: values.map((it) => Float64Array.from(whole, (row) => it[row])), sums: Float64Array.from(whole, (row) => sums[row]), count: whole.length };
  };

  const isBeaten = (point, by) => {
    for (let other = 0; other < by.count && by.sums[other] <= point.sum; other++) {
      let [worse, better] = [false, false];
      for (let j = 0; j < point.at.length && !worse; j++) {
        const difference = by.values[j][other] - point.at[j];
        worse = difference > 0;
        better = better || difference < 0;
      }
      if (!worse && better) return true;
    }
    return false;
  };

  // Of `designs` those that one of `others` beats; null once nobody waits for it.
  const countBeaten = async (designs, others, isOld) => {
    let beaten = 0;
    let from = performance.now();
    for (let row = 0; row < designs.count; row++) {
      if (isBeaten({ at: designs.values.map((it) => it[row]), sum: designs.sums[row] }, others)) beaten++;
      if (performance.now() - from < SLICE) continue;
      await new Promise((done) => setTimeout(done));
      if (isOld()) return null;
      from = performance.now();
    }
    return beaten;
  };

  page.compareFronts = async (other, isOld) => {
    const goals = page.goals();
    const [own, theirs] = [pointsOf(goals, page.front.byName, page.front.rows), pointsOf(goals, other.byName, other.rows)];
    const ownBeaten = await countBeaten(own, theirs, isOld);
    const theirBeaten = ownBeaten === null ? null : await countBeaten(theirs, own, isOld);
    return theirBeaten === null ? null : { ownBeaten, theirBeaten };
  };
}
