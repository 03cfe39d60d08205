//! What the user sees: text for people, JSON lines for machines, a bar on a terminal.

use super::failure::Failure;
use super::interrupt;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde::Serialize;
use std::io::{IsTerminal, Write};
use std::sync::Mutex;

/// Where messages go.
pub(super) struct Console {
    json: bool,
    quiet: bool,
    bar: ProgressBar,
    /// The last progress line in JSON: stage and per cent.
    last: Mutex<(String, u32)>,
}

/// One line of `--json`.
#[derive(Serialize)]
struct Event<'a, T: Serialize> {
    event: &'a str,
    #[serde(flatten)]
    body: T,
}

#[derive(Serialize)]
struct Progress<'a> {
    fraction: f64,
    stage: &'a str,
}

#[derive(Serialize)]
struct Problem {
    code: u8,
    message: String,
}

#[derive(Serialize)]
struct Note<'a> {
    message: &'a str,
}

impl Console {
    /// A bar is drawn only on a terminal, and neither with `--json` nor `--quiet`.
    pub fn new(json: bool, quiet: bool) -> Self {
        let bar = if json || quiet || !std::io::stderr().is_terminal() {
            ProgressBar::hidden()
        } else {
            let bar = ProgressBar::with_draw_target(Some(1000), ProgressDrawTarget::stderr());
            let style = ProgressStyle::with_template("{bar:30} {percent:>3} %  {msg}");
            bar.with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
        };
        Self { json, quiet, bar, last: Mutex::new((String::new(), 0)) }
    }

    /// Whether stdout is for machines.
    pub fn is_json(&self) -> bool {
        self.json
    }

    /// Text for people, on stdout; nothing with `--json` or `--quiet`.
    pub fn say(&self, text: &str) {
        if !self.json && !self.quiet {
            // A closed pipe is the reader's choice, no failure.
            let _ = writeln!(std::io::stdout(), "{text}");
        }
    }

    /// A warning: on stderr, also with `--quiet`; a line of its own with `--json`.
    pub fn warn(&self, text: &str) {
        if self.json {
            self.event("warning", &Note { message: text });
        } else {
            self.bar.suspend(|| eprint_line(&format!("warning: {text}")));
        }
    }

    /// One JSON line on stdout, only with `--json`.
    pub fn event(&self, event: &str, body: &impl Serialize) {
        if self.json {
            if let Ok(line) = serde_json::to_string(&Event { event, body }) {
                let _ = writeln!(std::io::stdout(), "{line}");
            }
        }
    }

    /// The last word of a failed command.
    pub fn fail(&self, failure: &Failure) {
        self.bar.finish_and_clear();
        let message = failure.to_string();
        eprint_line(&format!("error: {message}"));
        if let Some(hint) = failure.hint() {
            eprint_line(&format!("hint: {hint}"));
        }
        self.event("error", &Problem { code: failure.code(), message });
    }

    /// Shows progress; false asks the library to stop.
    pub fn progress(&self, fraction: f64, stage: &str) -> bool {
        if self.json {
            let percent = (100.0 * fraction) as u32;
            let mut last = self.last.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
            if last.1 != percent || last.0 != stage {
                *last = (stage.to_owned(), percent);
                self.event("progress", &Progress { fraction, stage });
            }
        } else {
            self.bar.set_message(stage.to_owned());
            self.bar.set_position((1000.0 * fraction) as u64);
        }
        !interrupt::requested()
    }

    /// A step that has no fraction: reading, drawing, writing.
    pub fn step(&self, stage: &str) {
        self.bar.set_message(stage.to_owned());
    }

    /// Takes the bar away before the summary.
    pub fn clear(&self) {
        self.bar.finish_and_clear();
    }
}

fn eprint_line(text: &str) {
    let _ = writeln!(std::io::stderr(), "{text}");
}

/// A length for people: four digits.
pub(super) fn short(x: f64) -> String {
    if x == 0.0 || !x.is_finite() {
        return format!("{x}");
    }
    let digits = (3 - x.abs().log10().floor() as i32).clamp(0, 9) as usize;
    if !(1e-4..1e7).contains(&x.abs()) {
        return format!("{x:.3e}");
    }
    format!("{x:.digits$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_have_four_digits() {
        for (x, text) in [
            (0.0, "0"),
            (0.012_345, "0.01235"),
            (1.0, "1.000"),
            (-12.345_6, "-12.35"),
            (123_456.7, "123457"),
            (1.234_5e-9, "1.235e-9"),
            (1e9, "1.000e9"),
        ] {
            assert_eq!(short(x), text);
        }
    }
}
