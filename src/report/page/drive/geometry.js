// An open belt over two pulleys, in millimetres: the driver's axis at 0, the driven pulley's at the centre distance.
{
  // Pitch radii for which a belt of this length fits, found by bisection: the length grows with the driver's radius.
  page.pitchRadii = (ratio, length, centres) => {
    const lengthOf = (driver) => {
      const sine = Math.max(-1, Math.min(1, ((ratio - 1) * driver) / centres));
      const lean = Math.asin(sine);
      return 2 * centres * Math.cos(lean) + Math.PI * (1 + ratio) * driver + 2 * lean * (ratio - 1) * driver;
    };
    let [low, high] = [0, centres / Math.max(Math.abs(ratio - 1), 1e-9)];
    high = Math.min(high, length);
    if (!(length > 2 * centres) || !(lengthOf(high) >= length)) return null;
    for (let step = 0; step < 100; step++) {
      const middle = (low + high) / 2;
      if (lengthOf(middle) < length) low = middle;
      else high = middle;
    }
    const driver = (low + high) / 2;
    return { driver, driven: ratio * driver };
  };

  // Half the angle that the belt does not touch on the driver: where its spans leave, seen from the driver's axis.
  const leave = (driver, driven, centres) => Math.acos(Math.max(-1, Math.min(1, (driver - driven) / centres)));

  page.wraps = (driver, driven, centres) => {
    const angle = leave(driver, driven, centres);
    return { driver: (360 * (Math.PI - angle)) / Math.PI, driven: (360 * angle) / Math.PI };
  };

  // The closed line that runs at these radii about both axes, as points; further out or in by `offset`.
  page.beltLine = (driver, driven, centres, offset = 0) => {
    const angle = leave(driver, driven, centres);
    const points = [];
    const arc = (x, radius, from, to) => {
      const steps = 96;
      for (let i = 0; i <= steps; i++) {
        const at = from + ((to - from) * i) / steps;
        points.push([x + (radius + offset) * Math.cos(at), (radius + offset) * Math.sin(at)]);
      }
    };
    arc(0, driver, angle, 2 * Math.PI - angle);
    arc(centres, driven, -angle, angle);
    return points;
  };
}
