// A timing belt's pulley: its teeth, the teeth of the belt on it, where they mesh and where they lift, and the ends of both spans.
{
  const DEPTH = 0.2; // of the pitch: depth of a tooth space, as trapezoidal teeth of pitch L have

  const RADIANS = Math.PI / 180;
  const polar = (radius, degrees) => [radius * Math.cos(degrees * RADIANS), radius * Math.sin(degrees * RADIANS)];

  // The outline of the pulley: tip lands and spaces one after the other, flanks at the pressure angle.
  const outline = ({ tip, land, space, depth, pressure, first }) => {
    const pitch = 2 * (land + space);
    const teeth = Math.max(1, Math.round(360 / pitch));
    const narrow = Math.max(0.1 * space, space - (depth * Math.tan(pressure * RADIANS)) / tip / RADIANS);
    return d3.range(teeth).flatMap((at) => {
      const middle = first + (360 * at) / teeth;
      return [polar(tip, middle - space), polar(tip - depth, middle - narrow), polar(tip - depth, middle + narrow), polar(tip, middle + space)];
    });
  };

  page.drawTimingBelt = (of) => {
    const reader = page.readerOf(of);
    const names = ["tip_radius_mm", "land_half_angle_deg", "space_half_angle_deg", "pressure_angle_deg", "teeth_in_mesh", "tight_span_angle_deg", "slack_span_angle_deg", "pitch_line_mm", "cord_area_mm2", "belt_width_mm"];
    const [tip, land, space, pressure, mesh, tight, slack, line, area, width] = names.map(reader.number);
    if (reader.missing.length) return { missing: reader.missing };
    const pitch = 2 * (land + space);
    const arc = (mesh - 1) * pitch + tight + slack;
    if (arc >= 360) return { none: `${mesh} teeth of ${page.short(pitch)}° do not fit on a pulley` };
    const depth = reader.chosen("depth of the tooth spaces", DEPTH * pitch * RADIANS * tip, "0.2 of the pitch");
    const back = area / width;
    reader.notes.push("both spans, which are cut off, and the bore");
    if (Math.abs(360 / pitch - Math.round(360 / pitch)) > 0.02) reader.notes.push(`the pulley's number of teeth, ${page.short(360 / pitch)} by its angles`);
    const lifted = page.quantityOf("boundary_tooth", of);
    // The arc is symmetrical about the top, the tight side on the right: tooth 1 is there.
    const first = 90 - ((mesh - 1) * pitch) / 2;
    const radius = tip + line;
    // Where the spans leave: the inclination of a span at the end tooth is the angle from there on.
    const [begin, end] = [first - tight, first + (mesh - 1) * pitch + slack];
    const span = 0.9 * tip;
    // The pulley turns round so that the belt lies on its upper side; a belt's line at some radius, spans at both ends.
    const beltLine = (r) => {
      const along = ([px, py], degrees, by) => [px + by * Math.cos(degrees * RADIANS), py + by * Math.sin(degrees * RADIANS)];
      const points = d3.range(0, 1.0001, 1 / 120).map((part) => polar(r, begin + part * (end - begin)));
      return [along(points[0], begin - 90, span), ...points, along(points[points.length - 1], end + 90, span)];
    };
    const low = Math.min(-tip, ...beltLine(radius).map((it) => it[1]));
    const across = Math.max(...beltLine(tip + back).map((it) => Math.abs(it[0])), tip);
    const title = "Timing belt on its pulley, to scale";
    const words = lifted && lifted.value <= mesh ? `, from tooth ${page.short(lifted.value)} on they lift in the worst scenario` : "";
    const description = `Tip radius ${page.short(tip)} mm, ${mesh} teeth in mesh over ${page.short(arc)}° from span to span${words}; belt ${page.short(back)} mm thick without its teeth.`;
    const sheet = page.sheetOf({ left: -across, right: across, top: tip + back, bottom: low }, { left: 14, right: 14, top: 18, bottom: 30 }, { title, description });
    sheet.polygon("pulley-body", outline({ tip, land, space, depth, pressure, first }));
    sheet.circle("pulley-bore", 0, 0, 0.2 * tip);
    sheet.between("belt", [...beltLine(tip + back), ...beltLine(tip).reverse()]);
    sheet.polygon("pitch-line", beltLine(radius), false);
    const narrow = Math.max(0.1 * space, space - (0.92 * depth * Math.tan(pressure * RADIANS)) / tip / RADIANS);
    for (let tooth = 1; tooth <= mesh; tooth++) {
      const middle = first + (tooth - 1) * pitch;
      const up = lifted !== null && tooth >= lifted.value;
      sheet.polygon(up ? "belt-tooth lifted" : "belt-tooth", [polar(tip, middle - 0.96 * space), polar(tip - 0.92 * depth, middle - narrow), polar(tip - 0.92 * depth, middle + narrow), polar(tip, middle + 0.96 * space)]);
    }
    sheet.angle([0, 0], sheet.scale * 0.62 * tip, begin, end, "");
    for (const degrees of [begin, end]) sheet.line("measure", [0, 0], polar(tip, degrees));
    sheet.label([0, 0.62 * tip], `${page.short(Number(arc.toFixed(1)))}°, ${mesh} teeth`, [0, 14]);
    sheet.radius(0, 0, tip, -90);
    sheet.label([0, -0.5 * tip], `tip r ${page.short(tip)} mm`, [6, 0], "start");
    const ends = beltLine(tip);
    sheet.label(ends[0], "tight side", [-8, -4], "end");
    sheet.label(ends[ends.length - 1], "slack side", [8, -4], "start");
    sheet.bar();
    const line1 = (name, value, unit) => ({ name, cells: [value, unit] });
    const table = { heads: ["", "value", "unit"], units: ["", "", ""], lines: [line1("pitch on the tips", page.short(pitch * RADIANS * tip), "mm"), line1("teeth of the pulley", page.short(Number((360 / pitch).toFixed(2))), ""), line1("arc from span to span", page.short(Number(arc.toFixed(1))), "°"), line1("belt without teeth", page.short(back), "mm")] };
    const liftText = lifted === null ? "" : lifted.value > mesh ? "No tooth lifts in the worst scenario. " : `Outlined: teeth from ${page.short(lifted.value)} on, which lift in the worst scenario; they are drawn in place. `;
    return { node: sheet.node(), notes: reader.notes, table, key: `${liftText}Thickness of the belt: cord_area_mm2 over belt_width_mm.` };
  };
}
