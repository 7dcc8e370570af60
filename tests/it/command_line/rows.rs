//! `eval --table`: the same as one by one, and nothing half written.

use super::feasible::parquet;
use super::{Csv, SMALL, ask, ask_words, folder_with, program, read, write};
use std::io::Write;
use std::path::Path;
use std::process::Stdio;

/// Rows with numbers, units and words.
const ROWS: &str = "# loads\nfriction,torque_Nm, traction,note\n0.08,50,limit,a\n0.09,60 N m,0.4,b\n9 %,20,0.9,\"c, d\"\n-0.0e0,1,0.1,e\n";

fn short(name: &str) -> String {
    ROWS.lines().filter(|line| !line.starts_with("-0.0")).map(|line| line.to_owned() + "\n").collect::<String>().replace("note", name)
}

/// The numbers of a row of a table, by name.
fn row(table: &Csv, at: usize) -> Vec<(&str, &str)> {
    table.header.iter().map(String::as_str).zip(table.rows[at].iter().map(String::as_str)).collect()
}

#[test]
fn rows_of_a_model_are_what_eval_says_of_each() {
    let folder = folder_with("rows.csv", &short("note"));
    let at = folder.path();
    let said = ask(at, "eval metal-cvt --table rows.csv --carry note --set ratio=0.8 --out out.csv").text();
    assert_eq!(said, "3 rows, in out.csv\n");
    let table = Csv::read(&at.join("out.csv"));
    assert_eq!(&table.header[..4], ["friction", "torque_Nm", "traction", "note"]);
    assert_eq!((table.column("note"), table.column("torque_Nm")), (vec!["a", "b", "c, d"], vec!["50", "60", "20"]));
    assert_eq!(
        (table.column("traction"), table.column("status")),
        (vec!["limit", "0.4", "0.9"], vec!["ok", "ok", "slip on the driven pulley"])
    );
    let words = [
        ["friction=0.08", "torque_Nm=50", "traction=limit"],
        ["friction=0.09", "torque_Nm=60", "traction=0.4"],
        ["friction=0.09", "torque_Nm=20", "traction=0.9"],
    ];
    for (number, words) in words.iter().enumerate() {
        let line: Vec<&str> =
            ["eval", "metal-cvt", "--json", "--set", "ratio=0.8"].into_iter().chain(words.iter().flat_map(|it| ["--set", it])).collect();
        let one = ask_words(at, &line).json();
        let mut seen = 0;
        for (name, cell) in row(&table, number).into_iter().skip(4).filter(|(name, _)| *name != "status") {
            let expected = one["outputs"].get(name).map(|it| it.as_f64().expect("a number"));
            assert_eq!(cell.parse().ok(), expected, "{name} of row {number}");
            seen += usize::from(expected.is_some());
        }
        assert!(seen > 5 && one["status"] == table.column("status")[number], "{one}");
    }
    // The same rows in other clothes.
    ask(at, "eval metal-cvt --table rows.csv --carry note --set ratio=0.8 --out out.parquet").text();
    let (names, cells) = parquet(&at.join("out.parquet"));
    let as_numbers = |cell: &String| cell.parse::<f64>().map_or_else(|_| cell.clone(), |it| it.to_string());
    let rows: Vec<Vec<String>> = table.rows.iter().map(|row| row.iter().map(as_numbers).collect()).collect();
    assert_eq!(
        (&names, &cells.iter().map(|row| row.iter().map(as_numbers).collect::<Vec<_>>()).collect::<Vec<_>>()),
        (&table.header, &rows)
    );
    let mut piped = program(at, &["eval", "metal-cvt", "--table", "-", "--carry", "note", "--set", "ratio=0.8"]);
    let mut child = piped.stdin(Stdio::piped()).spawn().expect("the program starts");
    child.stdin.take().expect("it reads").write_all(short("note").as_bytes()).expect("it takes rows");
    let output = child.wait_with_output().expect("it ends");
    assert_eq!(String::from_utf8(output.stdout).expect("it is text"), read(&at.join("out.csv")));
    // What was written can be read again: results are carried along, or left out.
    let inputs: String = table.rows.iter().map(|row| row[..3].join(",") + "\n").collect();
    write(at, "again.csv", &format!("friction,torque_Nm,traction\n{inputs}"));
    let again = ask(at, "eval metal-cvt --table again.csv --set ratio=0.8").text();
    assert!(again.lines().nth(1).is_some_and(|line| line.starts_with("0.08,50,limit,") && line.ends_with(",ok")), "{again}");
}

#[test]
fn more_rows_than_a_block_are_the_same_in_every_form() {
    let rows: String = (0..70_000).map(|it| format!("{},{}\n", 0.05 + f64::from(it) * 1e-6, 1 + it % 97)).collect();
    let folder = folder_with("rows.csv", &format!("friction,torque_Nm\n{rows}"));
    let at = folder.path();
    ask(at, "eval metal-cvt --table rows.csv --out out.csv").text();
    ask(at, "eval metal-cvt --table rows.csv --out out.parquet").text();
    let table = Csv::read(&at.join("out.csv"));
    let (names, cells) = parquet(&at.join("out.parquet"));
    assert_eq!((table.rows.len(), &table.header, cells.len()), (70_000, &names, 70_000));
    let forces = table.numbers("axial_force_N");
    let column = names.iter().position(|it| it == "axial_force_N").expect("it is there");
    for number in [0, 65_535, 65_536, 69_999] {
        assert_eq!(cells[number][column].parse(), Ok(forces[number]));
        let set = format!(
            "eval metal-cvt --json --set friction={} --set torque_Nm={}",
            table.column("friction")[number],
            table.column("torque_Nm")[number]
        );
        assert_eq!(ask(at, &set).json()["outputs"]["axial_force_N"].as_f64(), Some(forces[number]), "row {number}");
    }
    // Numbers of a Parquet file are read as they are.
    ask(at, "eval metal-cvt --table out.parquet --carry x --out no.csv").refusal(2);
}

/// The design inputs of the first designs of a front, as rows.
fn designs(front: &Csv, count: usize) -> String {
    let names = ["groove_angle_deg", "band_thickness_mm", "band_count", "traction"];
    let rows = (0..count).map(|row| names.map(|name| front.column(name)[row]).join(",") + "\n");
    names.join(",") + "\n" + &rows.collect::<String>()
}

#[test]
fn rows_of_a_study_are_its_designs() {
    let folder = folder_with("study.toml", SMALL);
    let at = folder.path();
    ask(at, "sweep study.toml --out r --quiet").text();
    let front = Csv::read(&at.join("r/front.csv"));
    let count = front.rows.len();
    // And one that is not feasible, as the study's own evaluation has it.
    write(at, "rows.csv", &(designs(&front, count) + "18,0.3,6,0.5\n"));
    ask(at, "eval study.toml --table rows.csv --out out.csv").text();
    let table = Csv::read(&at.join("out.csv"));
    for name in front.header.iter().filter(|name| *name != "design_index") {
        assert_eq!(table.column(name)[..count], front.column(name)[..], "{name}");
    }
    assert!(table.column("feasible")[..count].iter().all(|it| *it == "yes"));
    // Index of the last row in the grid: 13 x 21 x 9 x 5.
    let one = ask(at, &format!("eval study.toml --json --design {}", (20 * 9) * 5 + 4)).json();
    assert_eq!((one["feasible"].as_bool(), table.column("feasible")[count]), (Some(false), "no"));
    assert_eq!(one["status"], table.column("status")[count]);
    for constraint in one["constraints"].as_array().expect("there are some") {
        let name = format!("{}_margin", constraint["of"].as_str().expect("a name"));
        assert_eq!(table.column(&name)[count].parse().ok(), constraint["margin"].as_f64(), "{name}");
    }
    let cells = row(&table, count).into_iter().filter(|(name, _)| one["outputs"].get(name).is_some());
    assert!(cells.clone().count() >= 3);
    for (name, cell) in cells {
        assert_eq!(cell.parse().ok(), one["outputs"][name]["value"].as_f64(), "{name}");
    }
    // Any other input may have a column too, and one value may stand for an axis.
    write(at, "rows.csv", "groove_angle_deg,band_thickness_mm,band_count,strength_MPa\n18,0.3,6,800\n18,0.3,6,2000\n");
    let text = ask(at, "eval study.toml --table rows.csv --set traction=0.5 --set friction=0.095").text();
    let lines: Vec<&str> = text.lines().collect();
    let what_if =
        ask(at, &format!("eval study.toml --json --design {} --set friction=0.095 --set strength_MPa=2000", (20 * 9) * 5 + 4)).json();
    assert!(lines.len() == 3 && lines[1] != lines[2]);
    let value = lines[0].split(',').position(|it| it == "stress_margin").and_then(|at| lines[2].split(',').nth(at)).expect("it is there");
    assert_eq!(value.parse().ok(), what_if["outputs"]["stress_margin"]["value"].as_f64());
}

/// Rows, what else is asked, and what is said.
const WRONG: [(&str, &str, &str); 17] = [
    ("friction,torque_Nm\n0.1,50\n-1,50\n", "", "rows.csv:3: column \"friction\": -1 is out of range; it must be greater than 0"),
    ("friction\n0.1\nfast\n", "", "rows.csv:3: column \"friction\": \"fast\" is not a number with a unit; write for example \"12\""),
    // Line ends of Windows, and decimal commas.
    ("friction\r\n0.1\r\nfast\r\n", "", "rows.csv:3: column \"friction\": \"fast\" is not a number with a unit; write for example \"12\""),
    ("friction,ratio\r\n0.1,1\r\n0.1\r\n", "", "rows.csv:3: the row has 1 cells, the header 2; give every row the same"),
    (
        "strength_MPa\n\"700,5\"\n",
        "",
        "rows.csv:2: column \"strength_MPa\": \"700,5\" is not a number with a unit; write for example \"700.5\"",
    ),
    ("friction,ratio\n0.1,\n", "", "rows.csv:2: column \"ratio\": the cell is empty; give a value"),
    ("friction\nnan\n", "", "rows.csv:2: column \"friction\": NaN is out of range; it must be greater than 0"),
    ("band_count\n7.5\n", "", "rows.csv:2: column \"band_count\": 7.5 is not a whole number; use 7 or 8"),
    ("frictoin\n0.1\n", "", "rows.csv: column \"frictoin\": metal-cvt has no such input; did you mean \"friction\"?"),
    ("friction,note\n0.1,a\n", "", "rows.csv: column \"note\": metal-cvt has no such input; --carry note takes it along as it is"),
    (
        "friction,axial_force_N\n0.1,1\n",
        "",
        "rows.csv: column \"axial_force_N\": it is a result and no input; drop the column, or --carry axial_force_N takes it along as it is",
    ),
    (
        "friction,axial_force_N\n0.1,1\n",
        "--carry axial_force_N",
        "rows.csv: the result would have two columns \"axial_force_N\"; call the carried one otherwise",
    ),
    ("friction,note\n0.1,a\n", "--carry nota --carry note", "rows.csv: there is no column \"nota\" to carry; did you mean \"note\"?"),
    ("friction,friction\n0.1,1\n", "", "rows.csv: \"friction\" has two columns; drop one"),
    ("friction\n0.1\n", "--set friction=0.1", "rows.csv: column \"friction\": --set gives it too; keep one of the two"),
    ("friction,ratio\n0.1,1\n0.1\n", "", "rows.csv:3: the row has 1 cells, the header 2; give every row the same"),
    ("friction;ratio\n0.1;1\n", "", "rows.csv:1: the columns are not separated by commas; save the file with commas"),
];

/// The same for rows of [`SMALL`].
const WRONG_DESIGNS: [(&str, &str, &str); 3] = [
    (
        "groove_angle_deg,band_thickness_mm,band_count,traction,ratio\n18,0.1,6,0.3,1\n",
        "",
        "rows.csv: column \"ratio\": the study gives it in [operation], and judges every row over all of that; drop the column",
    ),
    (
        "groove_angle_deg,band_thickness_mm\n18,0.1\n",
        "",
        "the rows must say what the study chooses: there is no column band_count, traction; add it, or give one value with --set band_count=...",
    ),
    ("groove_angle_deg\n18\n", "--set friction=-1", "--set friction=-1: -1 is out of range; it must be greater than 0"),
];

#[test]
fn wrong_rows_are_named_and_nothing_is_half_written() {
    let folder = folder_with("study.toml", SMALL);
    let at = folder.path();
    let try_it = |target: &str, (rows, options, told): (&str, &str, &str)| {
        write(at, "rows.csv", rows);
        for out in ["", "--out out.csv", "--out out.parquet"] {
            let said = ask(at, &format!("eval {target} --table rows.csv {options} {out}")).refusal(2);
            assert_eq!(said, format!("error: {told}\n"));
        }
        let left: Vec<_> = at.read_dir().expect("it can be listed").map(|it| it.expect("listed").file_name()).collect();
        assert_eq!(left.len(), 2, "{left:?}");
    };
    WRONG.into_iter().for_each(|it| try_it("metal-cvt", it));
    WRONG_DESIGNS.into_iter().for_each(|it| try_it("study.toml", it));
    // An error far below leaves nothing of the rows above.
    let many: String = (0..70_000).map(|_| "0.1\n").collect();
    let late = format!("friction\n{many}-1\n");
    try_it("metal-cvt", (&late, "", "rows.csv:70002: column \"friction\": -1 is out of range; it must be greater than 0"));
}

#[test]
fn a_file_that_is_there_stays_unless_it_may_go() {
    let folder = folder_with("rows.csv", "friction\n0.1\n");
    let at = folder.path();
    write(at, "thesis.csv", "mine");
    let said = ask(at, "eval metal-cvt --table rows.csv --out thesis.csv").refusal(2);
    assert_eq!(said, "error: thesis.csv is there already; name another, or replace it with --force\n");
    assert_eq!(read(&at.join("thesis.csv")), "mine");
    assert_eq!(ask(at, "eval metal-cvt --table rows.csv --out thesis.csv --force").text(), "1 row, in thesis.csv\n");
    assert!(read(Path::new(&at.join("thesis.csv"))).starts_with("friction,driver_radius_mm"));
    // No rows are no error: the columns are there.
    write(at, "none.csv", "friction\n");
    assert_eq!(ask(at, "eval metal-cvt --table none.csv").text().lines().count(), 1);
}
