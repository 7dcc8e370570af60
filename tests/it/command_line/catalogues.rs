//! Catalogues: labels in every table of designs, columns that nothing uses, presets as an axis.

use super::report::data_of;
use super::{Answer, Csv, ask, changed, files, folder_with, json_of, program, read, same_result, write};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::RowAccessor;
use std::path::Path;
use std::time::{Duration, Instant};

/// A catalogue with everything that a text may have, and two rows that only their labels tell apart.
const CATALOGUE: &str = "# bands of a maker\n\npart_no,maker,band_thickness_mm,band_width_mm,price_EUR,colour\n# thin ones\n\
    007,\"Alpha, Ltd\",0.10,9,3,red\n008,\"Says \"\"hi\"\"\",0.15,9,4,red\n   \n0010,Beta,0.2,9,5,blue\n\"#11\",Beta,0.2,9,5,blue\n";

const STUDY: &str = r#"model = "metal-cvt"
title = "Bands of a catalogue"
units = ["EUR"]
labels = ["part_no", "maker"]
[design]
cases = { csv = "bands.csv", unused = "ok" }
band_count = { from = 6, to = 12 }
groove_angle_deg = { from = 18, to = 30, count = 5 }
[operation]
torque_Nm = [50, 150]
[formulas]
cost_EUR = "price_EUR * band_count"
[constraints]
stress_margin = { min = 0 }
[objectives]
cost_EUR = "min"
axial_force_N = "min"
[report]
top = { by = "axial_force_N", count = 30 }
sample = { count = 50 }
variants = true
"#;

/// A folder with the catalogue and the study.
fn place() -> tempfile::TempDir {
    let folder = folder_with("study.toml", STUDY);
    write(folder.path(), "bands.csv", CATALOGUE);
    folder
}

/// What the catalogue says of a band, by its number among the rows.
const PARTS: [[&str; 2]; 4] = [["007", "Alpha, Ltd"], ["008", "Says \"hi\""], ["0010", "Beta"], ["#11", "Beta"]];

/// The first design of a table whose labels are not those of its row of the catalogue: thirty-five designs share one row.
fn mislabelled(designs: &[&str], parts: &[&str], makers: &[&str]) -> Option<String> {
    designs.iter().zip(parts.iter().zip(makers)).find_map(|(design, (part, maker))| {
        let row: usize = design.parse::<usize>().expect("it is an index") / 35;
        (PARTS[row] != [*part, *maker]).then(|| format!("design {design}: {part}, {maker}"))
    })
}

#[test]
fn labels_are_in_every_table_as_the_catalogue_has_them() {
    let folder = place();
    let at = folder.path();
    let printed = ask(at, "sweep study.toml --out r").text();
    for name in ["front.csv", "top.csv", "sample.csv", "variants.csv"] {
        let Ok(true) = at.join("r").join(name).try_exists() else {
            assert_eq!(name, "sample.csv", "only the sample is Parquet");
            continue;
        };
        let table = Csv::read(&at.join("r").join(name));
        assert_eq!(table.header[..3], ["design_index", "part_no", "maker"], "{name}");
        let [designs, parts, makers] = ["design_index", "part_no", "maker"].map(|column| table.column(column));
        assert!(table.rows.len() > 1 && designs.len() == table.rows.len(), "{name}");
        assert_eq!(mislabelled(&designs, &parts, &makers), None, "{name}");
        assert!(mislabelled(&designs, &makers, &parts).is_some(), "the check sees exchanged columns");
    }
    let variants = Csv::read(&at.join("r/variants.csv"));
    assert_eq!(variants.rows.len(), 140);
    // The two rows that only labels tell apart are both kept, with the same values.
    let [third, fourth] = [&variants.rows[70..105], &variants.rows[105..]];
    assert!(third.iter().zip(fourth).all(|(a, b)| a[3..] == b[3..] && a[1] == "0010" && b[1] == "#11"));

    let front = Csv::read(&at.join("r/front.csv"));
    let parquet = std::fs::File::open(at.join("r/front.parquet")).expect("it is there");
    let parquet = SerializedFileReader::new(parquet).expect("it can be read");
    let about = parquet.metadata().file_metadata().key_value_metadata().expect("columns are described");
    assert!(about.iter().any(|it| it.key == "part_no.role" && it.value.as_deref() == Some("label")));
    let rows: Vec<_> = parquet.get_row_iter(None).expect("it has rows").map(|row| row.expect("it can be read")).collect();
    assert_eq!(rows.len(), front.rows.len());
    for (row, cells) in rows.iter().zip(&front.rows) {
        assert_eq!([row.get_string(1), row.get_string(2)].map(|it| it.expect("a text").as_str()), [&cells[1][..], &cells[2]]);
    }

    assert!(printed.lines().any(|line| line.trim_end().ends_with("design  part_no  maker")), "{printed}");
    assert!(printed.contains("  Alpha, Ltd\n") && printed.contains("knee: part_no "), "{printed}");
    let knee = &json_of(&at.join("r/summary.json"))["knee"]["labels"];
    assert!(PARTS.iter().any(|[part, maker]| knee["part_no"] == *part && knee["maker"] == *maker), "{knee}");
    let one = ask(at, "eval study.toml --design 70 --json").json();
    assert_eq!(one["labels"], serde_json::json!({ "part_no": "0010", "maker": "Beta" }));
    let one = ask(at, "eval study.toml --design 70 --scenario 1 --json").json();
    assert_eq!((&one["labels"]["part_no"], &one["scenario"]), (&"0010".into(), &1.into()));
    assert!(ask(at, "eval study.toml --design 0").text().contains("  part_no"));
}

#[test]
fn the_page_has_the_labels_and_a_table_with_another_label_is_refused() {
    let folder = place();
    let at = folder.path();
    ask(at, "sweep study.toml --out r").text();
    let data = data_of(&at.join("r/report.html"));
    let columns = data["front"]["columns"].as_array().expect("a front has columns");
    let column = |name: &str| columns.iter().find(|it| it["name"] == name).unwrap_or_else(|| panic!("{name} is missing"));
    assert_eq!((&column("part_no")["role"], &column("part_no")["type"]), (&"label".into(), &"u32".into()));
    let front = Csv::read(&at.join("r/front.csv"));
    for name in ["part_no", "maker"] {
        let mut words = front.column(name);
        words.sort_unstable();
        words.dedup();
        assert_eq!(column(name)["words"], serde_json::json!(words), "{name}");
    }
    assert_eq!((&data["top"]["labels"], &data["top"]["rows"][0][1]), (&serde_json::json!(["part_no", "maker"]), &"007".into()));

    let good = read(&at.join("r/front.csv"));
    let edits = [
        (",007,", ",7,", "part_no of design 1 is 7, and the study gives 007"),
        (",\"Alpha, Ltd\",", ",\"Alpha, Inc\",", "maker of design 1 is Alpha, Inc, and the study gives Alpha, Ltd"),
        (",\"Alpha, Ltd\",", ",Alpha Ltd,", "maker of design 1 is Alpha Ltd, and the study gives Alpha, Ltd"),
        (",\"Alpha, Ltd\",", ",\"Alpha, Ltd,", "a line has a quote that is not closed"),
        ("part_no", "part_nr", "its columns are not those of the study: \"part_nr\" in place of \"part_no\""),
    ];
    for (from, to, message) in edits {
        assert!(good.contains(from), "{from}");
        write(&at.join("r"), "front.csv", &good.replacen(from, to, 1));
        let answer = ask(at, "report r --force");
        assert!(answer.code != Some(0) && answer.err.contains(message), "{from}: {}", answer.err);
    }
    write(&at.join("r"), "front.csv", &good);
    ask(at, "report r --force").text();
}

/// Waits until a file is there.
fn wait_for(path: &Path) {
    let start = Instant::now();
    while !path.exists() {
        assert!(start.elapsed() < Duration::from_secs(60), "{} does not come", path.display());
        std::thread::sleep(Duration::from_micros(200));
    }
}

#[test]
fn a_result_outlives_its_catalogue() {
    let folder = place();
    let at = folder.path();
    let large = changed(STUDY, &[("to = 30, count = 5", "to = 30, count = 4001"), ("variants = true\n", "")]);
    write(at, "study.toml", &large);
    ask(at, "sweep study.toml --out one --engine cpu").text();
    for number in 1..=2 {
        ask(at, &format!("sweep study.toml --shard {number}/2 --out shard-{number}")).text();
    }
    let words = "sweep study.toml --out cut --engine cpu --threads 1".split_whitespace().collect::<Vec<_>>();
    let mut child = program(at, &words).spawn().expect("the program starts");
    wait_for(&at.join("cut/checkpoint/manifest.json"));
    child.kill().expect("it can be killed");
    child.wait().expect("it ends");
    assert!(!at.join("cut/summary.json").exists(), "the run was too fast to be cut off");
    std::fs::remove_file(at.join("bands.csv")).expect("it was there");

    ask(at, "merge shard-1 shard-2 --out two").text();
    let Answer { code, err, .. } = ask(at, "sweep study.toml --out cut --resume --engine cpu");
    assert_eq!(code, Some(0), "{err}");
    assert!(err.contains("study.toml:6:17: axis \"cases\": cannot read \"bands.csv\"") && err.contains("going on with the rows"), "{err}");
    let one = files(&at.join("one"));
    for other in ["two", "cut"] {
        same_result(&one, &files(&at.join(other))).unwrap_or_else(|problem| panic!("{other}: {problem}"));
    }
    let whole = read(&at.join("one/report.html"));
    ask(at, "report one --force").text();
    let again = data_of(&at.join("one/report.html"));
    assert!(whole.contains("Alpha, Ltd") && again["front"]["columns"][1]["words"].as_array().is_some_and(|it| it.contains(&"007".into())));

    // Without a checkpoint of the same study there is nothing to go on with.
    let refused = ask(at, "sweep study.toml --out new --resume").refusal(2);
    assert!(refused.contains("cannot read \"bands.csv\"") && !refused.contains("going on"), "{refused}");
}

#[test]
fn engines_threads_tiles_and_shards_give_the_same_bytes() {
    let folder = place();
    let at = folder.path();
    ask(at, "sweep study.toml --out one --engine cpu --threads 1").text();
    let one = files(&at.join("one"));
    for options in ["--engine gpu", "--engine cpu --threads 3 --tile 7", "--tile 1"] {
        ask(at, &format!("sweep study.toml --out other --force {options}")).text();
        same_result(&one, &files(&at.join("other"))).unwrap_or_else(|problem| panic!("{options}: {problem}"));
    }
    let parts: Vec<_> = (1..=3).map(|number| format!("part-{number}")).collect();
    for (number, part) in parts.iter().enumerate() {
        ask(at, &format!("sweep study.toml --shard {}/3 --out {part}", number + 1)).text();
    }
    ask(at, &format!("merge {} --out whole", parts.join(" "))).text();
    same_result(&one, &files(&at.join("whole"))).unwrap_or_else(|problem| panic!("{problem}"));
    let refused = ask(at, "sweep study.toml --out b --method bounds").refusal(2);
    assert!(refused.contains("cases in [design] are single designs"), "{refused}");

    // Sampled designs take whole rows.
    let sampled = changed(STUDY, &[("variants = true\n", ""), ("[operation]", "[sample]\nmethod = \"sobol\"\ncount = 300\n[operation]")]);
    write(at, "sampled.toml", &sampled);
    for engine in ["cpu", "gpu"] {
        ask(at, &format!("sweep sampled.toml --out sampled-{engine} --engine {engine}")).text();
    }
    let sampled = files(&at.join("sampled-cpu"));
    same_result(&sampled, &files(&at.join("sampled-gpu"))).unwrap_or_else(|problem| panic!("{problem}"));
    let top = Csv::read(&at.join("sampled-cpu/top.csv"));
    let price = |part: &str| ["007", "008", "0010", "#11"].iter().zip(["3", "4", "5", "5"]).find(|(it, _)| **it == part).map(|it| it.1);
    assert!(top.rows.len() == 30 && top.column("part_no").iter().zip(top.column("price_EUR")).all(|(it, own)| price(it) == Some(own)));
}

#[test]
fn rows_of_the_study_have_labels_too_and_a_study_without_labels_is_described_as_before() {
    let rows = r##"[
    { part_no = "007", maker = "Alpha, Ltd", band_thickness_mm = 0.10, band_width_mm = 9, price_EUR = 3 },
    { maker = "Says \"hi\"", part_no = "008", band_thickness_mm = 0.15, band_width_mm = 9, price_EUR = 4 },
    { part_no = "0010", maker = "Beta", band_thickness_mm = 0.2, band_width_mm = 9, price_EUR = 5 },
    { part_no = "#11", maker = "Beta", band_thickness_mm = 0.2, band_width_mm = 9, price_EUR = 5 },
]"##;
    let folder = place();
    let at = folder.path();
    write(at, "rows.toml", &changed(STUDY, &[("{ csv = \"bands.csv\", unused = \"ok\" }", rows)]));
    ask(at, "sweep rows.toml --out rows").text();
    let Answer { code, err, .. } = ask(at, "sweep study.toml --out csv");
    assert_eq!(code, Some(0));
    assert_eq!(err.matches("bands.csv: nothing uses the columns \"colour\"; they are left out").count(), 1, "{err}");
    let (mut one, mut other) = (files(&at.join("csv")), files(&at.join("rows")));
    // The texts of the two studies differ; what they mean does not.
    for files in [&mut one, &mut other] {
        files.remove("study.toml");
    }
    same_result(&one, &other).unwrap_or_else(|problem| panic!("{problem}"));
    let warned = ask(at, "check study.toml").text();
    assert!(warned.contains("warning: bands.csv: nothing uses the columns \"colour\"; they are left out\n"), "{warned}");

    let without = changed(STUDY, &[("labels = [\"part_no\", \"maker\"]\n", "")]);
    write(at, "bands.csv", &CATALOGUE.replace("\"#11\",Beta,0.2", "\"#11\",Beta,0.25"));
    write(at, "without.toml", &without);
    ask(at, "sweep without.toml --out without").text();
    assert!(!read(&at.join("without/study.json")).contains("labels"));
    assert!(read(&at.join("without/front.csv")).starts_with("design_index,band_thickness_mm,"));
}

/// Edits of the study and of the catalogue, and what is said of them.
const BROKEN: [(&str, &str, &str, &str, &str); 24] = [
    ("", "", "colour", "", "bands.csv:3:6: the column has no name; name the input whose values it holds"),
    (
        ", unused = \"ok\"",
        "",
        "",
        "",
        "bands.csv:3:6: metal-cvt has no input \"colour\"; list it in labels to carry it along as a text; its inputs are [..]; \
         unused = \"ok\" beside csv leaves the column out",
    ),
    (
        ", unused = \"ok\"",
        "",
        ",colour",
        ",makr",
        "bands.csv:3:6: metal-cvt has no input \"makr\"; did you mean \"maker\"? unused = \"ok\" beside csv leaves the column out",
    ),
    (
        ", unused = \"ok\"",
        "",
        ",colour",
        ",axial_force_N",
        "bands.csv:3:6: axial_force_N is an output; outputs can be constrained, made an objective or reported, only inputs can be given \
         values; unused = \"ok\" beside csv leaves the column out",
    ),
    ("unused = \"ok\"", "unused = true", "", "", "study.toml:6:39: axis \"cases\": found true, wanted a text in quotes"),
    ("unused = \"ok\"", "unused = \"all\"", "", "", "study.toml:6:39: axis \"cases\": unknown unused \"all\"; write \"ok\""),
    ("unused", "unusd", "", "", "study.toml:6:30: axis \"cases\": unknown key \"unusd\"; did you mean \"unused\"?"),
    (
        "labels = [\"part_no\", ",
        "labels = [\"part_no\", \"maker\", ",
        "",
        "",
        "study.toml:4:31: labels: \"maker\" is listed twice; drop one",
    ),
    (
        "labels = [\"part_no\", \"maker\"]",
        "labels = \"part_no\"",
        "",
        "",
        "study.toml:4:10: labels: found the text \"part_no\", wanted a list of columns such as [\"part_no\"]",
    ),
    (
        "labels = [\"part_no\"",
        "labels = [\"part_nr\"",
        "",
        "",
        "study.toml:4:11: label \"part_nr\": no cases of [design] have such a column; name a column of their CSV file, or drop it from labels",
    ),
    ("labels = [\"part_no\"", "labels = [7", "", "", "study.toml:4:11: labels: found the number 7, wanted a text in quotes"),
    (
        "labels = [\"part_no\"",
        "labels = [\"friction\"",
        "",
        "",
        "study.toml:4:11: label \"friction\": it is an input or a variable too, whose values are numbers; rename the label, or drop it from labels",
    ),
    (
        "labels = [\"part_no\"",
        "labels = [\"axial_force_N\"",
        "",
        "",
        "study.toml:4:11: label \"axial_force_N\": it is an output too, whose values are numbers; rename the label, or drop it from labels",
    ),
    (
        "labels = [\"part_no\"",
        "labels = [\"cost_EUR\"",
        "",
        "",
        "study.toml:4:11: label \"cost_EUR\": it is a formula too, whose values are numbers; rename the label, or drop it from labels",
    ),
    (
        "labels = [\"part_no\"",
        "labels = [\"price_EUR\"",
        "",
        "",
        "study.toml:4:11: label \"price_EUR\": a formula reads it, and a label is a text that is only carried along; drop it from labels if its \
         column has numbers",
    ),
    (
        "labels = [\"part_no\"",
        "labels = [\"design_index\"",
        "part_no",
        "design_index",
        "study.toml:4:11: label \"design_index\": tables have columns of such names themselves; rename it",
    ),
    (
        "labels = [\"part_no\"",
        "labels = [\"axial_force_N_lowest\"",
        "part_no",
        "axial_force_N_lowest",
        "study.toml:4:11: label \"axial_force_N_lowest\": tables have columns of such names themselves; rename it",
    ),
    (
        "labels = [\"part_no\"",
        "labels = [\"yield_low\"",
        "part_no",
        "yield_low",
        "study.toml:4:11: label \"yield_low\": tables have columns of such names themselves; rename it",
    ),
    (
        "labels = [\"part_no\"",
        "labels = [\"part no\"",
        "part_no",
        "part no",
        "study.toml:4:11: label \"part no\": a label's name has letters, digits and _, begins with a letter and is no longer than 80; rename it",
    ),
    ("", "", ",colour", ",maker", "bands.csv:3:6: \"maker\" has two columns; drop one"),
    ("", "", "\"#11\",Beta,0.25", "0010,Beta,0.2", "bands.csv:9:1: the row equals that of line 8; drop one"),
    (
        "",
        "",
        "008",
        "\"0\n08\"",
        "bands.csv:6:1: column \"part_no\": the text has a line end or another control character; write it on one line",
    ),
    (
        "torque_Nm = [50, 150]",
        "cases = [{ torque_Nm = 50, part_no = \"a\" }]",
        "",
        "",
        "study.toml:10:28: axis \"cases\": the label \"part_no\" cannot be in [operation]: labels are carried along with designs; drop the column",
    ),
    (
        "band_count = { from = 6, to = 12 }",
        "cases_2 = [{ part_no = \"x\", band_count = 6 }]",
        "",
        "",
        "study.toml:7:14: axis \"cases_2\": the label \"part_no\" has a column already; a label belongs to one axis, rename one of the two",
    ),
];

/// Does a message have this as one of its lines? `[..]` stands for anything.
pub fn says(message: &str, expected: &str) -> bool {
    message.lines().map(|line| line.strip_prefix("error: ").unwrap_or(line)).any(|line| match expected.split_once("[..]") {
        Some((start, end)) => line.starts_with(start) && line.ends_with(end),
        None => line == expected,
    })
}

#[test]
fn broken_catalogues_are_refused_at_their_place_with_a_remedy() {
    // Rows that differ in their numbers, so that nothing more is wrong without a label.
    let distinct = CATALOGUE.replace("\"#11\",Beta,0.2", "\"#11\",Beta,0.25");
    for (from, to, cell, other, expected) in BROKEN {
        let folder = place();
        let at = folder.path();
        if !from.is_empty() {
            write(at, "study.toml", &changed(STUDY, &[(from, to)]));
        }
        assert!(distinct.contains(cell), "{cell}");
        write(at, "bands.csv", &distinct.replacen(cell, other, usize::from(!cell.is_empty())));
        let refused = ask(at, "check study.toml").refusal(2);
        assert!(says(&refused, expected), "{from} {cell}: wanted\n{expected}\nand it says\n{refused}");
        assert_eq!(refused.lines().count(), 1, "{from} {cell}: {refused}");
    }
    // Rows of the study.
    let rows = |rows: &str| changed(STUDY, &[("{ csv = \"bands.csv\", unused = \"ok\" }", rows), (", \"maker\"", "")]);
    let band = "band_width_mm = 9, price_EUR = 3";
    let cases = [
        (
            format!("[{{ part_no = 7, {band} }}]"),
            "study.toml:6:22: axis \"cases\": label \"part_no\": found the number 7; a label is a text, write it in quotes",
        ),
        (
            format!("[{{ part_no = \"7\", {band} }}, {{ {band} }}]"),
            "study.toml:6:63: axis \"cases\": this row lacks part_no; give every row the same inputs",
        ),
        (
            format!("[{{ {band}, part_no = \"7\" }}, {{ {band}, part_no = \"7\" }}]"),
            "study.toml:6:63: axis \"cases\": this row equals that of line 6; drop one",
        ),
        (
            "[{ part_no = \"7\" }]\nprice_EUR = 3".to_owned(),
            "study.toml:6:10: axis \"cases\": the row has labels only; name an input, such as { friction = ..., groove_angle_deg = ... }",
        ),
    ];
    for (text, expected) in cases {
        let folder = folder_with("study.toml", &rows(&text));
        let refused = ask(folder.path(), "check study.toml").refusal(2);
        assert!(says(&refused, expected), "{text}: wanted\n{expected}\nand it says\n{refused}");
    }
    // A catalogue in which nothing is an input.
    let folder = folder_with("study.toml", &changed(STUDY, &[("price_EUR * ", ""), ("cost_EUR = \"band", "cost_EUR = \"3[EUR] * band")]));
    write(folder.path(), "bands.csv", "part_no,maker\n1,a\n2,b\n");
    let refused = ask(folder.path(), "check study.toml").refusal(2);
    assert!(
        says(&refused, "bands.csv:1:1: no column is an input or a variable; name at least one, such as friction, groove_angle_deg"),
        "{refused}"
    );
}

#[test]
fn the_shipped_study_on_a_catalogue_is_the_same_on_every_engine() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folder = tempfile::tempdir().expect("there is room");
    let sweep = |options: &str, name: &str| {
        let out = folder.path().join(name);
        let words = ["sweep", "studies/catalogue-v-belts.toml", "--out", out.to_str().expect("a path of characters")];
        let words: Vec<_> = words.into_iter().chain(options.split_whitespace()).collect();
        (super::ask_words(root, &words), out)
    };
    let (one, cpu) = sweep("--engine cpu", "cpu");
    assert!(one.text().contains("front     "));
    let (other, gpu) = sweep("--engine gpu", "gpu");
    other.text();
    same_result(&files(&cpu), &files(&gpu)).unwrap_or_else(|problem| panic!("{problem}"));
    let refused = sweep("--method bounds", "bounds").0.refusal(2);
    assert!(refused.contains("cases in [design] are single designs"), "{refused}");
    // A section is chosen with its own belt, and on a pulley within the groove's range.
    let front = Csv::read(&cpu.join("front.csv"));
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_path(root.join("catalogues/v-grooves.csv")).expect("it is shipped");
    let header: Vec<_> = reader.headers().expect("it has a header").iter().map(str::to_owned).collect();
    let belts: Vec<csv::StringRecord> = reader.records().map(|row| row.expect("rows are as long as the header")).collect();
    assert!(front.rows.len() >= 3);
    let of_front = ["section", "groove_angle_deg", "groove_width_mm", "above_diameter_mm", "up_to_diameter_mm", "belt_top_width_mm"];
    let places = of_front.map(|name| header.iter().position(|it| it == name).expect("the catalogue has it"));
    let rows: Vec<Vec<&str>> = belts.iter().map(|row| places.iter().map(|&at| &row[at]).collect()).collect();
    let radius = front.numbers("mean_radius_mm");
    for (row, radius) in radius.iter().enumerate() {
        let cells: Vec<_> = of_front.iter().map(|name| front.column(name)[row]).collect();
        assert!(rows.contains(&cells), "{cells:?}");
        let [above, up_to] = [3, 4].map(|at| cells[at].parse::<f64>().expect("a number"));
        assert!(2.0 * radius > above && 2.0 * radius <= up_to, "{cells:?} with {radius}");
    }
}
