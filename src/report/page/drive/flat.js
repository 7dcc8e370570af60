// A flat belt over two pulleys.
page.drawFlatBelt = (of) => {
  const reader = page.readerOf(of);
  const names = ["driver_diameter_mm", "driven_diameter_mm", "centre_distance_mm", "belt_width_mm", "belt_thickness_mm"];
  const [driver, driven, centres, width, thickness] = names.map(reader.number);
  if (reader.missing.length) return { missing: reader.missing };
  const radii = { driver: driver / 2, driven: driven / 2 };
  const face = reader.chosen("width of the pulleys", 1.1 * width, "1.1 of the belt's");
  const shaft = reader.chosen("shafts", page.shaftOf(Math.min(radii.driver, radii.driven)), "0.3 of the smaller radius");
  const pulleys = [
    { cx: 0, pitch: radii.driver, beltSide: -1 },
    { cx: centres, pitch: radii.driven, beltSide: 1 },
  ].map((it) => ({ ...it, outer: it.pitch, shaft, halfWidth: face / 2, tangent: null }));
  const high = Math.max(radii.driver, radii.driven) + thickness;
  const reach = page.sectionReach(pulleys);
  const [left, right] = [-radii.driver - thickness, centres + radii.driven + thickness];
  const middle = -high - (46 * (right - left)) / 376 - reach;
  const title = "Flat belt over two pulleys, to scale";
  const description = `Driver ${page.short(driver)} mm and driven pulley ${page.short(driven)} mm in diameter, ${page.short(centres)} mm apart; belt ${page.short(width)} mm wide and ${page.short(thickness)} mm thick.`;
  const sheet = page.sheetOf({ left, right, top: high, bottom: middle - reach }, { left: 12, right: 12, top: 18, bottom: 42 }, { title, description });
  page.sideView(sheet, { radii, centres, thickness, inside: false, ghosts: [], notes: reader.notes });
  sheet.label([0, radii.driver], `Ø ${page.short(driver)} mm`, [0, -8]);
  sheet.label([centres, 0], `Ø ${page.short(driven)} mm`, [0, -10]);
  sheet.across([0, -high], [centres, -high], 22, `${page.short(centres)} mm`);
  const at = (pitch, side) => [pitch, (side * width) / 2];
  const strip = ({ pitch }) => [at(pitch, -1), at(pitch + thickness, -1), at(pitch + thickness, 1), at(pitch, 1)];
  page.sectionView(sheet, middle, reach, pulleys, { parts: (pulley) => [{ kind: thickness * sheet.scale < 1.2 ? "belt-line" : "belt", points: strip(pulley) }] });
  sheet.label([centres / 2, middle], `belt ${page.short(width)} × ${page.short(thickness)} mm`, [0, 4]);
  sheet.bar();
  const wraps = page.wraps(radii.driver, radii.driven, centres);
  const line = (name, diameter, wrap) => ({ name, cells: [page.short(diameter), page.short(Number(wrap.toFixed(1)))] });
  const table = { heads: ["", "diameter", "wrap"], units: ["", "mm", "°"], lines: [line("driver", driver, wraps.driver), line("driven", driven, wraps.driven)] };
  return { node: sheet.node(), notes: reader.notes, table, key: "" };
};
