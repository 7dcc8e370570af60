// A variator: both pulleys at the ratio that is shown, the circles of the ends of the ratio, the belt, and the section with its groove.
{
  const BLOCK = 8 / 3; // width of a push belt's block over that of a band

  // The belt in the section, as pieces (radius, distance from the middle plane).
  const rubber = ({ width, thickness, tangent }) => ({
    parts: ({ pitch }) => {
      const at = (offset) => width / 2 + offset * tangent;
      const [low, high] = [-thickness / 2, thickness / 2];
      return [{ kind: "belt", points: [[pitch + low, -at(low)], [pitch + high, -at(high)], [pitch + high, at(high)], [pitch + low, at(low)]] }];
    },
  });

  const pushBelt = ({ bandWidth, thickness, width, tangent }) => ({
    parts: ({ pitch }) => {
      // Blocks are as high as they are not known to be: from the bands inwards by a third of their width.
      const block = [[pitch - width / 3, width / 2 - (width / 3) * tangent], [pitch, width / 2], [pitch + thickness / 2, width / 2]];
      const pack = (side) => {
        const middle = (side * width * 1) / 4;
        return [[pitch - thickness / 2, middle - bandWidth / 2], [pitch + thickness / 2, middle - bandWidth / 2], [pitch + thickness / 2, middle + bandWidth / 2], [pitch - thickness / 2, middle + bandWidth / 2]];
      };
      return [{ kind: "block", points: [...block, ...block.map(([radius, z]) => [radius, -z]).reverse()] }, { kind: "belt", points: pack(-1) }, { kind: "belt", points: pack(1) }];
    },
  });

  const beltOf = (reader, metal) => {
    if (!metal) return { thickness: reader.number("belt_thickness_mm"), width: reader.number("belt_width_mm"), what: "belt" };
    const [bands, each, bandWidth] = ["band_count", "band_thickness_mm", "band_width_mm"].map(reader.number);
    const width = reader.chosen("blocks", BLOCK * bandWidth, `8/3 of a band wide, ${page.short(BLOCK * bandWidth)} mm, and a third of that high`);
    return { thickness: bands * each, bandWidth, width, what: `pack of ${bands} bands`, text: `${bands} bands of ${page.short(each)} mm` };
  };

  // The ratio: its ends, and the one that is shown.
  page.ratioOf = (of) => {
    const ratio = page.quantityOf("ratio", of);
    if (!ratio) return null;
    const known = ratio.from === "varied" && ratio.least < ratio.largest;
    return { ...ratio, ends: known ? [ratio.least, ratio.largest] : null, first: known ? Math.max(ratio.least, Math.min(ratio.largest, 1)) : ratio.value };
  };

  page.drawVariator = (of, metal, shown) => {
    const reader = page.readerOf(of);
    const [centres, length, groove] = ["centre_distance_mm", "belt_length_mm", "groove_angle_deg"].map(reader.number);
    const belt = beltOf(reader, metal);
    const ratio = page.ratioOf(of);
    if (!ratio || reader.missing.length) return { missing: ratio ? reader.missing : ["ratio", ...reader.missing] };
    const at = (value) => page.pitchRadii(value, length, centres);
    const radii = at(shown);
    if (!radii) return { none: `a belt of ${page.short(length)} mm does not fit around pulleys of this ratio at a centre distance of ${page.short(centres)} mm` };
    const ends = (ratio.ends || []).map((value) => ({ value, radii: at(value) })).filter((end) => end.radii);
    const most = (which) => Math.max(radii[which], ...ends.map((end) => end.radii[which]));
    const least = Math.min(radii.driver, radii.driven, ...ends.flatMap((end) => [end.radii.driver, end.radii.driven]));
    const tangent = Math.tan((groove * Math.PI) / 360);
    const shaft = reader.chosen("shafts", page.shaftOf(least), "0.3 of the least pitch radius");
    const margin = Math.max(belt.thickness / 2, 0.02 * least);
    reader.notes.push("sheaves, which end a little above the greatest pitch radius of the ratios");
    const pulleys = [
      { cx: 0, pitch: radii.driver, outer: most("driver") + margin, beltSide: -1 },
      { cx: centres, pitch: radii.driven, outer: most("driven") + margin, beltSide: 1 },
    ].map((it) => ({ ...it, shaft, halfWidth: belt.width / 2, tangent }));
    // The section lies below the side view, far enough for the dimensions between them; its room does not move with the ratio.
    const high = Math.max(...pulleys.map((it) => it.outer));
    const widest = pulleys.map((it, i) => ({ ...it, pitch: Math.min(it.pitch, ...ends.map((end) => end.radii[i ? "driven" : "driver"])) }));
    const reach = page.sectionReach(widest);
    const gap = 44 / (376 / (centres + pulleys[0].outer + pulleys[1].outer));
    const middle = -high - gap - reach;
    const title = `${metal ? "Push belt" : "V-belt"} variator at ratio ${page.short(shown)}, to scale`;
    const description = `Centre distance ${page.short(centres)} mm, pitch radius of the driver ${page.short(radii.driver)} mm, of the driven pulley ${page.short(radii.driven)} mm, ${belt.what} ${page.short(belt.thickness)} mm thick, groove angle ${page.short(groove)}°.`;
    const sheet = page.sheetOf({ left: -pulleys[0].outer, right: centres + pulleys[1].outer, top: high, bottom: middle - reach }, { left: 12, right: 12, top: 16, bottom: 46 }, { title, description });
    const { notes } = reader;
    page.sideView(sheet, { radii, centres, thickness: belt.thickness, inside: true, ghosts: ends.map((end) => end.radii), notes });
    sheet.radius(0, 0, radii.driver, 90);
    sheet.radius(centres, 0, radii.driven, 90);
    sheet.label([0, 0], `r ${page.short(radii.driver)} mm`, [6, -10], "start");
    sheet.label([centres, 0], `r ${page.short(radii.driven)} mm`, [-6, -10], "end");
    sheet.label([0, 0], "driver", [0, 18]);
    sheet.label([centres, 0], "driven", [0, 18]);
    sheet.across([0, -high], [centres, -high], 22, `${page.short(centres)} mm`);
    page.sectionView(sheet, middle, reach, pulleys, metal ? pushBelt({ ...belt, tangent }) : rubber({ ...belt, tangent }));
    sheet.bar();
    sheet.foot(`groove ${page.short(groove)}°, ${belt.text || `belt ${page.short(belt.width)} × ${page.short(belt.thickness)} mm`}`);
    const line = (name, value, found) => ({ name, cells: [page.short(value), page.short(found.driver), page.short(found.driven), ...Object.values(page.wraps(found.driver, found.driven, centres)).map((it) => page.short(Number(it.toFixed(1))))] });
    const table = { heads: ["", "ratio", "r driver", "r driven", "wrap driver", "wrap driven"], units: ["", "", "mm", "mm", "°", "°"], lines: [...ends.map((end, i) => line(["least", "greatest"][i] || "", end.value, end.radii)), line("shown", shown, radii)] };
    if (ends.length === 2) table.lines = [table.lines[0], table.lines[2], table.lines[1]];
    return { node: sheet.node(), notes, table, key: ends.length ? "Dashed: pitch circles at the ends of the ratio." : "", radii };
  };
}
