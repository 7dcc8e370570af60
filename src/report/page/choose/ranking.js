// Weights and wished values, and the order in which they put the designs of the front.
//
// Each objective of a design falls short by s = (value - best) / (worst - best) on the front, r of which its wished value would (without one
// r = 0, the best). The score is the largest w (s - r) of all objectives that have a weight, plus a thousandth of the sum of all s - r, which
// decides between equals: the augmented Chebyshev distance of Wierzbicki (1980). The least score comes first.
{
  const USUAL = 50; // weight of an objective that was not touched
  const SUM = 1e-3;
  let weights = new Map(); // name -> 0 to 100, of those that were moved
  let wishes = new Map(); // name -> value
  let known = null; // { front, losses, scores, order, reached }

  // The columns of the objectives, each once.
  page.goals = () => [...new Map(page.front.objectives.map(({ column, goal }) => [column.name, { name: column.name, column, goal }])).values()];

  page.weightOf = (name) => weights.get(name) ?? USUAL;
  page.wishOf = (name) => wishes.get(name);

  // Weights that add up to 1; all alike where each is 0.
  page.shares = () => {
    const given = page.goals().map(({ name }) => page.weightOf(name));
    const sum = d3.sum(given);
    return given.map((weight) => (sum > 0 ? weight / sum : 1 / given.length));
  };

  // Is there another answer than that of equal weights?
  page.isWeighed = () => {
    if (!page.front || !page.front.rows) return false;
    const goals = page.goals();
    return goals.some(({ name }) => wishes.has(name)) || new Set(page.shares()).size > 1;
  };

  const tell = () => {
    known = null;
    page.events.call("choice");
  };

  page.setWeight = (name, weight) => {
    if (weight === USUAL) weights.delete(name);
    else weights.set(name, weight);
    tell();
  };

  page.setWish = (name, value) => {
    if (value === null) wishes.delete(name);
    else wishes.set(name, value);
    tell();
  };

  page.clearWeights = () => {
    weights.clear();
    wishes.clear();
    tell();
  };

  // How far a value is from the best on the front to the worst.
  const lossOf = ({ column, goal }, value) => {
    const span = column.high - column.low;
    if (!(span > 0)) return 0;
    return (goal === "max" ? column.high - value : value - column.low) / span;
  };

  // Of every objective: s - r, row by row. An absent value is worse than any other.
  const shortfalls = () =>
    page.goals().map((goal) => {
      const wished = wishes.has(goal.name) ? lossOf(goal, wishes.get(goal.name)) : 0;
      return Float64Array.from(goal.column.values, (value) => (Number.isFinite(value) ? lossOf(goal, value) - wished : 1e9));
    });

  // The rows with the least scores, the least first; of equal ones the first row of the table.
  const least = (scores, count) => {
    const best = [];
    scores.forEach((score, row) => {
      if (best.length === count && !(score < scores[best[count - 1]])) return;
      best.push(row);
      best.sort((a, b) => scores[a] - scores[b] || a - b);
      if (best.length > count) best.pop();
    });
    return best;
  };

  page.scoreOf = (short, shares, row) => {
    let largest = -Infinity;
    let sum = 0;
    for (let j = 0; j < short.length; j++) {
      const by = short[j][row];
      sum += by;
      if (shares[j] > 0 && shares[j] * by > largest) largest = shares[j] * by;
    }
    return largest + SUM * sum;
  };
  page.sumShare = SUM;

  // What the weights and wishes make of the front.
  page.ranking = () => {
    if (known && known.front === page.front) return known;
    const short = shortfalls();
    const shares = page.shares();
    const scores = Float64Array.from({ length: page.front.rows }, (_, row) => page.scoreOf(short, shares, row));
    const isWished = page.goals().map(({ name }) => wishes.has(name));
    let reached = 0;
    for (let row = 0; row < page.front.rows; row++) if (short.every((by, j) => !isWished[j] || by[row] <= 1e-12)) reached++;
    known = { front: page.front, short, shares, scores, order: least(scores, 5), reached };
    return known;
  };

  // Rows with the best last, as they are painted; null where there are so many that ordering them would be felt.
  const MOST_ORDERED = 20000;
  let painted = null;
  page.paintOrder = () => {
    if (page.front.rows > MOST_ORDERED || !page.front.objectives.length) return null;
    const found = page.ranking();
    if (painted?.of !== found) painted = { of: found, order: Uint32Array.from(found.scores.keys()).sort((a, b) => found.scores[b] - found.scores[a] || b - a) };
    return painted.order;
  };

  // The design that stands for the whole front, and what it is called.
  page.chosenRow = () => (page.isWeighed() ? page.ranking().order[0] : page.front && page.front.knee);
  page.chosenWord = () => (page.isWeighed() ? "first by weights" : "knee");

  // In the address: those that were set, by name.
  const text = (map) => [...map].map(([name, value]) => `${encodeURIComponent(name)}:${value}`).join(",");
  page.weightsText = () => text(weights);
  page.wishesText = () => text(wishes);

  const read = (given, isGood) => {
    const names = new Set(page.goals().map(({ name }) => name));
    const pairs = (given || "").split(",").map((part) => part.split(":"));
    const named = pairs.map(([name, value]) => [page.decoded(name), value ? Number(value) : NaN]);
    return new Map(named.filter(([name, value]) => names.has(name) && isGood(value)));
  };

  page.readWeights = (ofWeights, ofWishes) => {
    weights = read(ofWeights, (value) => value >= 0 && value <= 100);
    wishes = read(ofWishes, Number.isFinite);
    tell();
  };
}
