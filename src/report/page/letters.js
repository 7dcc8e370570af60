// The letters of pinned designs. Those that would cover each other stand around their dots, with a line to them.
{
  const RADIUS = 7;
  const APART = 2 * RADIUS + 1;
  const CLEAR = RADIUS + 4; // from the middle of a letter to the dot of another design
  const RINGS = [0, ...d3.range(APART + 1, 7 * APART, 8)];
  const TURNS = 16;

  const ringsOf = (x, y) => RINGS.flatMap((reach) => d3.range(reach ? TURNS : 1).map((turn) => [x + reach * Math.cos((2 * Math.PI * turn) / TURNS), y + reach * Math.sin((2 * Math.PI * turn) / TURNS)]));
  const isNear = ([x, y], [a, b], reach) => Math.hypot(x - a, y - b) < reach;

  // Where each of these letters stands: { letter, x, y } in px, within [left, top, right, bottom]; `beside` px to the right of its dot.
  page.letterPlaces = (pins, [left, top, right, bottom], beside = 0) => {
    const taken = [];
    return pins.map((pin) => {
      const isFree = (at) => at[0] >= left && at[0] <= right && at[1] >= top && at[1] <= bottom && !taken.some((it) => isNear(at, it, APART)) && !pins.some((it) => it !== pin && isNear(at, [it.x, it.y], beside ? 0 : CLEAR));
      const own = [pin.x + beside, pin.y];
      const at = ringsOf(...own).find(isFree) ?? own;
      taken.push(at);
      return { ...pin, at, isAside: at[0] !== own[0] || at[1] !== own[1] };
    });
  };

  page.drawLetters = (group, pins, bounds, beside = 0) => {
    for (const { letter, x, y, at, isAside } of page.letterPlaces(pins, bounds, beside)) {
      if (isAside) {
        group.append("path").attr("class", "pin-leader").attr("d", `M${x},${y}L${at}`);
        group.append("circle").attr("class", "pin-dot").attr("r", 2.5).attr("cx", x).attr("cy", y);
      }
      group.append("circle").attr("class", "pin-dot").attr("r", RADIUS).attr("cx", at[0]).attr("cy", at[1]).attr("data-letter", letter);
      group.append("text").attr("class", "pin-text").attr("x", at[0]).attr("y", at[1] + 3.5).attr("text-anchor", "middle").text(letter);
    }
  };
}
