// A V-belt pulley: seen along its shaft with the arc of contact, and the section of its rim with the grooves.
{
  // Where the model has no dimensions of the groove: its width as a share of the mean radius, its depth to either side of that radius as a
  // share of its width.
  const WIDTH = 0.2;
  const DEPTH = 0.4;

  // The section of a design as lines of (z, r), if the page knows it.
  const outlineOf = (of) => {
    const { sections } = page.data;
    const found = of.section ?? page.knownSections.get(page.front)?.get(of) ?? sections?.outlines[sections.of[page.numberOfDesign(of)]];
    return found ? found.map((part) => d3.range(0, part.length, 2).map((i) => [part[i], part[i + 1]])) : null;
  };

  // Above and below the axis, with the mean radius across it; `at` is where it begins.
  const drawOutline = (sheet, outline, at, broad, radius) => {
    for (const side of [1, -1]) {
      for (const part of outline) sheet.polygon("pulley-body cut", part.map(([z, r]) => [at + z, side * r]));
      sheet.polygon("hidden-line", [[at, side * radius], [at + broad, side * radius]], false);
    }
  };

  const dimensions = (reader, whole, radius, tangent) => {
    if (whole) {
      const [width, above, below, rim, bore, bracket] = ["groove_width_mm", "groove_height_mm", "floor_depth_mm", "rim_height_mm", "bore_diameter_mm", "bracket_diameter_mm"].map(reader.number);
      return { top: width, above, below, rim, bore: bore / 2, bracket: bracket / 2, known: true };
    }
    // A catalogue may say how wide the groove is at its top.
    const top = reader.known("groove_width_mm");
    const middle = top === null ? reader.chosen("width of a groove at the mean radius", WIDTH * radius, `${page.short(WIDTH * radius)} mm, ${WIDTH} of it`) : top / (1 + 2 * DEPTH * tangent);
    reader.notes.push(`depth of the groove, ${DEPTH} of its width to either side of the mean radius`, "rim and bore");
    const above = DEPTH * middle;
    return { top: top ?? middle + 2 * above * tangent, above, below: above, rim: 0.06 * middle, bore: 0.3 * radius, bracket: null, known: false };
  };

  page.drawPulley = (of, whole) => {
    const reader = page.readerOf(of);
    const [radius, groove, count, wrap] = ["mean_radius_mm", "groove_angle_deg", "groove_count", "wrap_angle_deg"].map(reader.number);
    const tangent = Math.tan((groove * Math.PI) / 360);
    const { top, above, below, rim, bore, bracket, known } = dimensions(reader, whole, radius, tangent);
    if (reader.missing.length) return { missing: reader.missing };
    const half = (height) => Math.max(0, top / 2 - (above - height) * tangent);
    const outer = radius + above + rim;
    const floor = radius - below;
    const outline = whole ? outlineOf(of) : null;
    const [least, most] = outline ? d3.extent(outline.flat(), ([z]) => z) : [0, 0];
    const land = outline ? 0.18 * top : reader.chosen(count > 1 ? "distance between the grooves" : "thickness of the rim beside the groove", 0.18 * top, `${page.short(0.18 * top)} mm, 0.18 of the groove's width`);
    const under = 0.12 * outer;
    if (known && !outline) reader.notes.push("what lies between groove and bore, which is dashed");
    // The section beside the front view, at the same height, as a drawing has it: the groove's place in the section is where it is cut.
    const pitch = top + land;
    const broad = outline ? most - least : count * pitch + land;
    const away = outer + 0.22 * outer;
    const title = `V-belt pulley${count > 1 ? ` with ${count} grooves` : ""}, to scale`;
    const description = `Mean radius ${page.short(radius)} mm, groove angle ${page.short(groove)}°, wrap ${page.short(wrap)}°${known ? `, outer radius ${page.short(outer)} mm` : ""}.`;
    const sheet = page.sheetOf({ left: -outer, right: away + broad, top: outer, bottom: -outer }, { left: 12, right: known ? 84 : 12, top: 30, bottom: 36 }, { title, description });
    // Front view.
    sheet.circle("pulley-body", 0, 0, outer);
    sheet.circle("ghost-circle", 0, 0, radius);
    if (bracket !== null) sheet.circle("hidden-line", 0, 0, bracket);
    sheet.circle("pulley-bore", 0, 0, bore);
    const polar = (r, degrees) => [r * Math.cos((degrees * Math.PI) / 180), r * Math.sin((degrees * Math.PI) / 180)];
    const [from, to] = [90 - wrap / 2, 90 + wrap / 2];
    const arc = (r) => d3.range(0, 1.0001, 1 / 96).map((part) => polar(r, from + part * (to - from)));
    sheet.between("belt", [...arc(radius + above), ...arc(floor + 0.3 * below).reverse()]);
    for (const degrees of [from, to]) sheet.line("measure", [0, 0], polar(radius, degrees));
    sheet.angle([0, 0], sheet.scale * (bore + 0.55 * (radius - bore)), from, to, "");
    sheet.label(polar(bore + 0.55 * (radius - bore), 90), `${page.short(wrap)}°`, [0, -4]);
    sheet.radius(0, 0, radius, -60);
    sheet.label(polar(0.45 * radius, -60), `mean r ${page.short(radius)} mm`, [10, 10], "start");
    // Section of the rim, above and below the axis.
    if (outline) drawOutline(sheet, outline.map((part) => part.map(([z, r]) => [z - least, r])), away, broad, radius);
    const profile = [];
    profile.push([0, floor - under], [0, outer]);
    for (let at = 0; at < count; at++) {
      const middle = land + top / 2 + at * pitch;
      const edge = half(above);
      profile.push([middle - edge, outer], [middle - edge, radius + above], [middle - half(-below), floor], [middle + half(-below), floor], [middle + edge, radius + above], [middle + edge, outer]);
    }
    profile.push([broad, outer], [broad, floor - under]);
    for (const side of outline ? [] : [1, -1]) {
      sheet.polygon("pulley-body cut", profile.map(([z, r]) => [away + z, side * r]));
      for (let at = 0; at < count; at++) {
        const middle = away + land + top / 2 + at * pitch;
        const [low, high] = [radius - 0.7 * below, radius + above];
        sheet.polygon("belt", [[middle - half(-0.7 * below), side * low], [middle - half(above), side * high], [middle + half(above), side * high], [middle + half(-0.7 * below), side * low]]);
      }
      sheet.polygon("hidden-line", [[away, side * (floor - under)], [away, side * bore], [away + broad, side * bore], [away + broad, side * (floor - under)]], false);
    }
    sheet.line("axis-line", [away - 0.06 * outer, 0], [away + broad + 0.06 * outer, 0]);
    sheet.label([away + broad / 2, outer], `groove ${page.short(groove)}°`, [0, -16]);
    // What stands on a rule has no dimension.
    if (known) sheet.upright([away + broad, 0], [away + broad, outer], 12, `r ${page.short(outer)} mm`);
    sheet.bar();
    const entry = (name, value, unit) => ({ name, cells: [page.short(value), unit] });
    const own = known ? [entry("groove at its top", top, "mm"), entry("floor radius", floor, "mm"), entry("bore", 2 * bore, "mm"), entry("bracket", 2 * bracket, "mm")] : [];
    const ofCatalogue = !known && reader.known("groove_width_mm") !== null ? [entry("groove at its top", top, "mm")] : [];
    const table = { heads: ["", "value", "unit"], units: ["", "", ""], lines: [entry("groove angle", groove, "°"), entry("mean radius", radius, "mm"), ...(known ? [entry("outer radius", outer, "mm")] : []), entry("grooves", count, ""), ...ofCatalogue, ...own] };
    return { node: sheet.node(), notes: reader.notes, table, key: bracket === null ? "Dashed: mean radius." : "Dashed: mean radius, bracket." };
  };
}
