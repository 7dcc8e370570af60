//! The fixed addresses of the server.

use super::Explorer;
use super::controls::controls;
use super::http::{Connection, HttpRequest, Reply, begin_chunks, write_chunk};
use crate::certify;
use crate::error::{Error, Result};
use crate::live::LiveAnswer;
use crate::live::around::{PLACES, around_with};
use crate::live::given::given_ranges;
use crate::models::Models;
use crate::plan::Plan;
use crate::report::{givens, inputs, live as told, sections, slices};
use crate::screen::Control;
use crate::study::{Axis, Label, Quantity, ReportColumn, Study, number, value_of};
use serde::Deserialize;
use serde_json::{Map, Value, json};
use std::io;
use std::net::TcpStream;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, PoisonError};
use std::time::Duration;

const JSON: &str = "application/json";
/// Parts of an answer: of each the lengths of its JSON and of its numbers, in four bytes each, then both.
const PARTS: &str = "application/octet-stream";
/// Stands before a command that needs the study as a file.
const NO_COMMAND: &str = "# no options say all of these changes; save the study as study.toml, then\n";
const MAPS_LEFT_OUT: &str =
    "The command and the study to save are without maps: one of them shows an objective that does not count now, or has too many cells.";
/// Seconds of a thread that slices over what the study gives may take.
const MOST_SECONDS: f64 = 2.0;
/// Most changes of a study.
const MOST_CHANGES: usize = 200;
/// How often it is seen whether the browser still waits.
const LOOK: Duration = Duration::from_millis(10);

/// What a page asks.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Question {
    /// Changes of the study, as `--set` takes them.
    #[serde(default)]
    set: Vec<String>,
    /// The tab that asks; its new question ends its last one.
    #[serde(default)]
    tab: u64,
    /// A design, by its index as text: more digits than a browser's numbers have.
    #[serde(default)]
    design: Option<String>,
}

/// One part of an answer.
type ToldPart = (Value, Vec<u8>);

impl Explorer {
    /// Answers a request that was let in.
    pub(super) fn route(&self, asked: &HttpRequest, connection: &mut Connection) -> io::Result<()> {
        let closes = asked.closes;
        let mut reply = |reply: Reply| reply.write(&mut connection.stream, closes);
        match (asked.method.as_str(), asked.path.as_str()) {
            ("GET", "/") => return reply(Reply::file("text/html; charset=utf-8", told::live_page().into_bytes())),
            ("GET", path) => {
                return match told::LIVE_FILES.iter().find(|(name, ..)| *name == path) {
                    Some((_, kind, parts)) => reply(Reply::file(kind, parts.concat().concat().into_bytes())),
                    None => reply(Reply::text(404, "there is nothing at this address")),
                };
            }
            ("POST", "/start" | "/study" | "/answer" | "/design" | "/around") => {}
            ("POST", _) => return reply(Reply::text(404, "there is nothing at this address")),
            _ => return reply(Reply::text(405, "GET and POST are what this server understands")),
        }
        if !asked.content_type.starts_with(JSON) {
            return reply(Reply::text(415, "a question is JSON"));
        }
        let question: Question = match serde_json::from_slice(&asked.body) {
            Ok(question) => question,
            Err(error) => return reply(Reply::text(400, &format!("this is no question: {error}"))),
        };
        if question.set.len() > MOST_CHANGES {
            return reply(Reply::text(400, &format!("a question has {MOST_CHANGES} changes at most")));
        }
        let control = Arc::new(Control::default());
        if asked.path == "/answer" {
            let older = self.tabs.lock().unwrap_or_else(PoisonError::into_inner).insert(question.tab, Arc::clone(&control));
            older.inspect(|it| it.stop.store(true, Ordering::Relaxed));
        }
        let done = self.tell(&asked.path, &question, &control, connection);
        let mut tabs = self.tabs.lock().unwrap_or_else(PoisonError::into_inner);
        if tabs.get(&question.tab).is_some_and(|it| Arc::ptr_eq(it, &control)) {
            tabs.remove(&question.tab);
        }
        done
    }

    /// Works on a question beside the connection, which ends the work when the browser goes.
    fn tell(&self, path: &str, question: &Question, control: &Arc<Control>, connection: &mut Connection) -> io::Result<()> {
        let (sender, parts) = channel::<ToldPart>();
        std::thread::scope(|scope| {
            let work = move || {
                let mut tell = |part: ToldPart| {
                    // Nobody listens any more: the work is being stopped.
                    let _ = sender.send(part);
                    Ok(())
                };
                let done = match path {
                    "/start" => self.start(question, control, &mut tell),
                    "/study" => self.study(question, &mut tell),
                    "/answer" => self.answer(question, control, &mut tell),
                    "/design" => self.design(question, control, &mut tell),
                    _ => self.around(question, control, &mut tell),
                };
                match done {
                    Ok(()) | Err(Error::Stopped { .. }) => {}
                    Err(error) => drop(tell((json!({ "kind": "error", "message": error.to_string() }), Vec::new()))),
                }
            };
            let done = (|| {
                begin_chunks(&mut connection.stream, PARTS)?;
                std::thread::Builder::new().spawn_scoped(scope, work)?;
                loop {
                    match parts.recv_timeout(LOOK) {
                        Ok(part) => write_part(&mut connection.stream, &part)?,
                        Err(RecvTimeoutError::Timeout) if connection.is_open() => {}
                        Err(RecvTimeoutError::Timeout) => return Err(io::ErrorKind::ConnectionAborted.into()),
                        Err(RecvTimeoutError::Disconnected) => return write_chunk(&mut connection.stream, &[]),
                    }
                }
            })();
            if done.is_err() {
                control.stop.store(true, Ordering::Relaxed);
            }
            done
        })
    }

    /// The study as its file has it, and what can be changed in it.
    fn start(&self, question: &Question, control: &Control, tell: &mut dyn FnMut(ToldPart) -> Result<()>) -> Result<()> {
        let (study, text) = self.live.study(&[])?;
        let plan = Plan::new(study);
        let mut told = self.described(&plan, &text, &question.set);
        told["controls"] = controls(&plan, &text, self.live.threads(), control)?;
        tell((told, Vec::new()))
    }

    /// The study with its changes, and the command that says it.
    fn study(&self, question: &Question, tell: &mut dyn FnMut(ToldPart) -> Result<()>) -> Result<()> {
        let (study, text) = self.live.study(&question.set)?;
        tell((self.described(&Plan::new(study), &text, &question.set), Vec::new()))
    }

    fn described(&self, plan: &Plan, text: &str, set: &[String]) -> Value {
        let (command, evaluate) = self.commands(plan, set).map_or_else(
            || (format!("{NO_COMMAND} beltspace sweep study.toml"), format!("{NO_COMMAND} beltspace eval study.toml --design {{design}}")),
            |set| ((self.words)("sweep", &set), (self.words)("eval", &set) + " --design {design}"),
        );
        let mut told = told::study(&self.live, plan, text, &command, &evaluate);
        if self.lacks_maps(plan) {
            told["notes"].as_array_mut().expect("they are a list").push(MAPS_LEFT_OUT.into());
        }
        told
    }

    /// What the file's study must be set to for that of a page; `None` if no options say it.
    fn commands(&self, plan: &Plan, set: &[String]) -> Option<Vec<String>> {
        if self.begin.is_empty() && !self.lacks_maps(plan) {
            return Some(set.to_vec());
        }
        let name = |it: &str| it.split('=').next().map(|name| name.trim().trim_start_matches("fixed.").to_owned());
        let is_changed = |it: &&String| set.iter().any(|other| name(other) == name(it));
        let all: Vec<String> = self.begin.iter().filter(|it| !is_changed(it)).chain(set).cloned().collect();
        let study = Study::parse_set(&Models::new(), &self.file_text, self.live.file(), self.live.folder(), &all);
        study.is_ok_and(|(study, _)| study.hash() == plan.study.hash()).then_some(all)
    }

    /// Were maps of the file left out, which the changed study cannot have?
    fn lacks_maps(&self, plan: &Plan) -> bool {
        plan.study.report.maps.is_empty() && self.has_maps
    }

    fn answer(&self, question: &Question, control: &Control, tell: &mut dyn FnMut(ToldPart) -> Result<()>) -> Result<()> {
        let (study, text) = self.live.study(&question.set)?;
        let plan = Plan::new(study);
        let mut study = Some(self.described(&plan, &text, &question.set));
        self.live.answer(&plan, control, &mut |step| {
            let (kind, (mut json, bytes)) = match step {
                LiveAnswer::Coarse(found, exact) => ("coarse", told::coarse(&found, exact)),
                LiveAnswer::Few(found) => ("few", told::front(&found)),
                LiveAnswer::Exact(found) => ("exact", told::front(&found)),
                LiveAnswer::Certified(found) => ("certified", told::front(&found)),
                LiveAnswer::Counted(counted) => ("counted", told::counted(&plan, &counted)),
            };
            json["kind"] = kind.into();
            // It comes with the first step.
            if let Some(study) = study.take() {
                json["study"] = study;
            }
            tell((json, bytes))
        })
    }

    /// The plan of a question, the design that it is about, and the text of the study.
    fn asked_design(&self, question: &Question) -> Result<(Plan, u64, String)> {
        let (study, text) = self.live.study(&question.set)?;
        let plan = Plan::new(study);
        let design = question.design.as_deref().and_then(|it| it.parse().ok()).filter(|&it: &u64| it < plan.designs());
        match design {
            Some(design) => Ok((plan, design, text)),
            None => Err(Error::Request(format!("there is no such design; the study's designs are 0 to {}", plan.designs() - 1))),
        }
    }

    /// Every output of a design at its worst scenario.
    fn design(&self, question: &Question, control: &Control, tell: &mut dyn FnMut(ToldPart) -> Result<()>) -> Result<()> {
        let (plan, design, _) = self.asked_design(question)?;
        let mut everything = plan.study.clone();
        let further = (0..everything.model.outputs.len()).map(|output| ReportColumn::from(Quantity::Output(output)));
        everything.report.columns.extend(further.filter(|it| !plan.study.is_proven(it.of)));
        let columns = certify::columns(&everything);
        let row = certify::rows(&plan, &columns, &[design], 1, control)?.remove(0);
        let model = &plan.study.model;
        let named = columns.iter().zip(&row.columns).map(|(column, at)| {
            let value = at.value.map(number);
            json!({ "name": column.name, "unit": column.unit(&plan.study), "doc": column.doc(&plan.study), "value": value, "scenario": value.as_ref().map(|_| at.scenario) })
        });
        let chosen = plan.study.design.iter().flat_map(Axis::inputs);
        let inputs = chosen.map(|&input| (model.inputs[input].name.clone(), value_of(model, input, row.inputs[input])));
        // Rows of a catalogue say which part it is.
        let text =
            |label: &Label| label.texts[usize::try_from(plan.space.level(label.axis, design)).expect("a row that is in memory")].clone();
        let labels = plan.study.labels.iter().map(|label| (label.name.clone(), text(label).into()));
        let inputs: Map<_, _> = inputs.chain(labels).collect();
        let scenarios: std::collections::BTreeSet<u64> = row.columns.iter().filter(|it| it.value.is_some()).map(|it| it.scenario).collect();
        let told = json!({
            "kind": "design", "design": design.to_string(), "inputs": inputs, "outputs": named.collect::<Vec<_>>(), "feasible": row.feasible,
            "status": row.status.reason(model), "without_result": row.without_result,
            "scenarios": told::scenarios(&plan, &scenarios), "section": sections::of_design(&plan, design),
            "givens": givens::of_design(&plan, design), "described": inputs::inputs(&plan.study),
        });
        tell((told, Vec::new()))
    }

    /// What is around a design.
    fn around(&self, question: &Question, control: &Control, tell: &mut dyn FnMut(ToldPart) -> Result<()>) -> Result<()> {
        let (plan, design, text) = self.asked_design(question)?;
        // Seconds of a thread, as far as they may be taken.
        #[allow(clippy::cast_precision_loss, reason = "an estimate")]
        let fits = |slices: usize| {
            let effort = plan.effort();
            MOST_SECONDS > (effort.prepare + effort.finish) * (PLACES * slices as u64) as f64
        };
        let given = given_ranges(&plan.study, &text).as_far_as(fits);
        let (columns, slices) = around_with(&plan, design, PLACES, &given.ranges, self.live.threads(), control)?;
        let mut told = slices::told(&plan, &columns, &slices, &given);
        told["kind"] = "around".into();
        tell((told, Vec::new()))
    }
}

/// Writes a part as one chunk.
fn write_part(out: &mut TcpStream, (json, bytes): &ToldPart) -> io::Result<()> {
    let json = json.to_string();
    let length = |length: usize| u32::try_from(length).map_err(|_| io::Error::from(io::ErrorKind::InvalidData));
    let mut part = Vec::with_capacity(8 + json.len() + bytes.len());
    part.extend_from_slice(&length(json.len())?.to_le_bytes());
    part.extend_from_slice(&length(bytes.len())?.to_le_bytes());
    part.extend_from_slice(json.as_bytes());
    part.extend_from_slice(bytes);
    write_chunk(out, &part)
}
