// Two pulleys and their belt, seen along the shafts, and below that a section through both axes: what variators and flat belts share.
{
  const RIM = 0.05; // of the outer radius: how thick a sheave is at its edge
  const SHAFT = 0.3; // of the least radius

  // A belt thinner than this many px would not be seen.
  const SEEN = 1.2;

  page.sideView = (sheet, { radii, centres, thickness, inside, ghosts, notes }) => {
    for (const { driver, driven } of ghosts) {
      sheet.circle("ghost-circle", 0, 0, driver);
      sheet.circle("ghost-circle", centres, 0, driven);
    }
    sheet.circle("pulley-body", 0, 0, radii.driver);
    sheet.circle("pulley-body", centres, 0, radii.driven);
    // A variator's belt lies about its pitch line, a flat one on the pulley.
    const [low, high] = inside ? [-thickness / 2, thickness / 2] : [0, thickness];
    const line = (offset) => page.beltLine(radii.driver, radii.driven, centres, offset);
    if (thickness * sheet.scale >= SEEN) {
      sheet.between("belt", line(high), line(low));
    } else {
      sheet.polygon("belt-line", line((low + high) / 2));
      notes.push(`thickness of the belt in the side view, ${page.short(thickness)} mm is drawn as a line`);
    }
    for (const cx of [0, centres]) sheet.line("axis-mark", [cx - 5 / sheet.scale, 0], [cx + 5 / sheet.scale, 0]);
    for (const cx of [0, centres]) sheet.line("axis-mark", [cx, -5 / sheet.scale], [cx, 5 / sheet.scale]);
  };

  // Pieces of a sheave or pulley in the section: `profile` as points (radius, distance from the middle plane), on all four sides.
  const mirrored = (sheet, kind, cx, middle, profile) => {
    for (const side of [-1, 1]) for (const end of [-1, 1]) sheet.polygon(kind, profile.map(([radius, z]) => [cx + side * radius, middle + end * z]));
  };

  // A sheave: its flank, at half the groove's angle, passes the edge of the belt at the pitch radius.
  const sheave = ({ pitch, outer, shaft, halfWidth, tangent }) => {
    const flank = (radius) => halfWidth + (radius - pitch) * tangent;
    const inner = Math.max(shaft, pitch - halfWidth / Math.max(tangent, 1e-9));
    const back = flank(outer) + RIM * outer;
    return { profile: [[inner, flank(inner)], [outer, flank(outer)], [outer, back], [shaft, back], ...(inner > shaft ? [[shaft, 0], [inner, 0]] : [])], back };
  };

  // How far the section reaches from its middle plane, for room on the sheet.
  page.sectionReach = (pulleys) => Math.max(...pulleys.map((it) => (it.tangent === null ? it.halfWidth : sheave(it).back))) * 1.12;

  page.sectionView = (sheet, middle, reach, pulleys, belt) => {
    for (const pulley of pulleys) {
      const { cx, pitch, outer, shaft, halfWidth, tangent, beltSide } = pulley;
      sheet.polygon("shaft", [[cx - shaft, middle - reach], [cx + shaft, middle - reach], [cx + shaft, middle + reach], [cx - shaft, middle + reach]]);
      // A flat pulley is a cylinder.
      if (tangent === null) for (const side of [-1, 1]) sheet.polygon("pulley-body", [[shaft, -halfWidth], [pitch, -halfWidth], [pitch, halfWidth], [shaft, halfWidth]].map(([radius, z]) => [cx + side * radius, middle + z]));
      else mirrored(sheet, "pulley-body", cx, middle, sheave({ pitch, outer, shaft, halfWidth, tangent }).profile);
      for (const part of belt.parts(pulley)) sheet.polygon(part.kind, part.points.map(([radius, z]) => [cx + beltSide * radius, middle + z]));
      sheet.line("axis-line", [cx, middle - reach - 3 / sheet.scale], [cx, middle + reach + 3 / sheet.scale]);
    }
  };

  page.shaftOf = (least) => SHAFT * least;
}
