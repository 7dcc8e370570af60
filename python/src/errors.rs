//! Errors of the library as exceptions, which `beltspace/_errors.py` defines.

use beltspace::Error;
use beltspace::study::StudyErrors;
use pyo3::exceptions::{PyOSError, PyRuntimeError};
use pyo3::prelude::*;

/// The exception of that name with these arguments.
fn exception<'py>(py: Python<'py>, name: &str, arguments: impl pyo3::call::PyCallArgs<'py>) -> PyErr {
    let made = py.import("beltspace._errors").and_then(|module| module.getattr(name)?.call1(arguments));
    made.map_or_else(|error| error, |made| PyErr::from_value(made))
}

/// Options of the command line that messages advise, and what one writes in Python.
const OPTIONS: [(&str, &str); 12] = [
    ("--engine cpu", "engine=\"cpu\""),
    ("--engine gpu", "engine=\"gpu\""),
    ("--method bounds", "method=\"bounds\""),
    ("--method exhaustive", "method=\"exhaustive\""),
    ("--engine", "engine"),
    ("--method", "method"),
    ("--adapter", "adapter"),
    ("--threads", "threads"),
    ("--feasible", "feasible=True"),
    ("--set replaces", "with_values replaces"),
    ("--set gives", "with_values gives"),
    ("--set ", "with_values: "),
];

/// A message as it is told in Python.
fn told(message: &str) -> String {
    OPTIONS.iter().fold(message.to_owned(), |text, (option, here)| text.replace(option, here))
}

/// The exception for an error.
pub fn raised(py: Python<'_>, error: Error) -> PyErr {
    match error {
        Error::Study(errors) => of_study(py, &errors),
        Error::Io { path, source } => match source.raw_os_error() {
            // As Python raises it: FileNotFoundError and the like, with the name of the file.
            Some(number) => {
                let reason = py.import("os").and_then(|os| os.call_method1("strerror", (number,))?.extract::<String>());
                PyOSError::new_err((number, reason.unwrap_or_else(|_| source.to_string()), path.display().to_string()))
            }
            None => PyOSError::new_err(format!("{}: {source}", path.display())),
        },
        Error::Disagreement(_) => PyRuntimeError::new_err(error.to_string()),
        other => {
            let name = if other.exit_code() == 2 { "RequestError" } else { "RunError" };
            exception(py, name, (told(&other.to_string()),))
        }
    }
}

/// The exception for what is wrong with a study or a model.
pub fn of_study(py: Python<'_>, errors: &StudyErrors) -> PyErr {
    let problems: Vec<_> = errors.problems.iter().map(|it| (it.file.clone(), it.line, it.column, told(&it.message))).collect();
    exception(py, "StudyError", (told(&errors.to_string()), problems))
}

/// The exception for a wrong request.
pub fn request(py: Python<'_>, text: impl Into<String>) -> PyErr {
    exception(py, "RequestError", (text.into(),))
}
