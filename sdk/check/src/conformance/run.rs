//! Starts the program under test (the reader) once for each conformance file.

use std::num::NonZero;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use super::answer::Answer;
use super::compare::Outcome;
use super::line::{CommandLine, Filled};
use super::process::{Ended, run as run_process};
use super::report::Report;
use super::tasks::{Asked, Task, tasks};
use super::{Class, ConformanceError, Part};

/// What to run, and the limits of each run.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Options {
    /// The folder `spec` of htex, which contains the folders of conformance files.
    pub files: PathBuf,
    /// The parts to run. The function skips a part that has no files.
    pub parts: Vec<Part>,
    /// The classes to count.
    pub classes: Vec<Class>,
    /// Time limit of one run.
    pub time_limit: Duration,
    /// Number of readers that run at the same time.
    pub jobs: NonZero<usize>,
}

impl Options {
    /// Returns options for all parts and classes: 30 s for each file, one reader at a time.
    pub fn new(files: impl Into<PathBuf>) -> Self {
        Self {
            files: files.into(),
            parts: Part::ALL.to_vec(),
            classes: Class::ALL.to_vec(),
            time_limit: Duration::from_secs(30),
            jobs: NonZero::<usize>::MIN,
        }
    }
}

/// Runs a reader on the conformance files. Calls `stop` every few milliseconds, and ends early if
/// `stop` returns true.
///
/// Before this function returns, it kills all processes of the reader's process group.
///
/// # Errors
/// Returns an error if the folder has no files, if a file cannot be read, if the reader cannot be
/// started, or if the run was stopped.
pub fn run(
    line: &CommandLine,
    options: &Options,
    stop: &(dyn Fn() -> bool + Sync),
) -> Result<Report, ConformanceError> {
    let mut all = Vec::new();
    for part in &options.parts {
        all.extend(tasks(&options.files, *part)?);
    }
    if all.is_empty() {
        return Err(ConformanceError::Files {
            path: options.files.clone(),
            problem: "there are no conformance files of these parts".to_owned(),
        });
    }
    let is_asked = |task: &Task| {
        let is_default = task.options.as_object().is_none_or(serde_json::Map::is_empty);
        is_default || line.takes_options()
    };
    let (all, left_out): (Vec<Task>, Vec<Task>) = all.into_iter().partition(is_asked);
    let questions = tempfile::tempdir()
        .map_err(|error| ConformanceError::File { path: std::env::temp_dir(), error })?;
    let outcomes = run_all(line, &all, options, questions.path(), stop)?;
    Ok(Report::new(line, options, &all, outcomes, &left_out))
}

/// Runs several readers at the same time, and returns the outcomes in the order of the tasks.
fn run_all(
    line: &CommandLine,
    all: &[Task],
    options: &Options,
    questions: &Path,
    stop: &(dyn Fn() -> bool + Sync),
) -> Result<Vec<Outcome>, ConformanceError> {
    let next = AtomicUsize::new(0);
    let error = Mutex::new(None);
    let has_failed = || error.lock().map_or(true, |error| error.is_some());
    let stop_all = || stop() || has_failed();
    let work = || {
        let mut done = Vec::new();
        while !has_failed() {
            let number = next.fetch_add(1, Ordering::Relaxed);
            let Some(task) = all.get(number) else { break };
            match outcome(
                line,
                task,
                options.time_limit,
                &questions.join(number.to_string()),
                &stop_all,
            ) {
                Ok(Some(outcome)) => done.push((number, outcome)),
                Ok(None) => {
                    fail(&error, ConformanceError::Stopped { done: number, all: all.len() });
                }
                Err(problem) => fail(&error, problem),
            }
        }
        done
    };
    let mut outcomes: Vec<(usize, Outcome)> = std::thread::scope(|scope| {
        let workers = options.jobs.get().min(all.len());
        let workers: Vec<_> = (0..workers).map(|_| scope.spawn(work)).collect();
        workers.into_iter().flat_map(|worker| worker.join().unwrap_or_default()).collect()
    });
    if let Some(error) = error.into_inner().ok().flatten() {
        return Err(error);
    }
    outcomes.sort_by_key(|(number, _)| *number);
    Ok(outcomes.into_iter().map(|(_, outcome)| outcome).collect())
}

/// Keeps the first error.
fn fail(error: &Mutex<Option<ConformanceError>>, problem: ConformanceError) {
    if let Ok(mut error) = error.lock() {
        error.get_or_insert(problem);
    }
}

/// Runs the reader on one file; `None` if the run was stopped.
fn outcome(
    line: &CommandLine,
    task: &Task,
    time_limit: Duration,
    question: &Path,
    stop: &(dyn Fn() -> bool + Sync),
) -> Result<Option<Outcome>, ConformanceError> {
    let file = match &task.asked {
        Asked::File(file) => file.clone(),
        Asked::Question(value) => {
            let file = question.with_extension("json");
            std::fs::write(&file, value.to_string())
                .map_err(|error| ConformanceError::File { path: file.clone(), error })?;
            file
        }
    };
    let Some(path) = file.to_str() else {
        return Err(ConformanceError::Files {
            path: file,
            problem: "the path is not UTF-8, so no reader can be told it".to_owned(),
        });
    };
    let options = task.options.to_string();
    let command = line.command(&Filled { file: path, part: task.part.name(), options: &options });
    let ended =
        run_process(command, time_limit, stop).map_err(|error| ConformanceError::Command {
            command: line.text().to_owned(),
            problem: format!("cannot be started: {error}"),
        })?;
    let expected = &task.expected;
    Ok(match ended {
        Ended::Stopped => None,
        Ended::Failed(sentence) => Some(Outcome::failed(expected, sentence)),
        Ended::Answered(bytes) => Some(match Answer::read(&bytes) {
            Ok(answer) => Outcome::of(expected, &answer),
            Err(sentence) => Outcome::failed(expected, sentence),
        }),
    })
}

#[cfg(test)]
#[cfg(unix)]
mod tests {
    use super::*;
    use std::time::Instant;

    use serde_json::{Value, json};

    /// A folder of conformance files: two assets, one more with a limit, two blocks, and an asset
    /// to play.
    fn files() -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        let write = |path: &str, value: Value| {
            let path = folder.path().join(path);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, value.to_string()).unwrap();
        };
        let found = json!([{"code": "BAND_INVALID", "pointer": "/band", "severity": "error"}]);
        let report = |file: &str, valid: bool, findings: Value| json!({"file": format!("{file}.htex"), "valid": valid, "findings": findings});
        write("conformance/good.report.json", report("good", true, json!([])));
        write("conformance/bad.report.json", report("bad", false, found.clone()));
        let mut limited = report("large", false, found);
        limited["limits"] = json!({"values": 1});
        write("conformance/large.report.json", limited);
        write(
            "baked-conformance/tone.json",
            json!({"block": "tone.bin", "valid": true, "seed": 7, "steps": [{"render": 4}],
                "samples": {"sha256": "aa"}, "integers": {"sha256": "bb"}}),
        );
        write(
            "baked-conformance/refused.json",
            json!({"block": "refused.bin", "valid": false, "rule": "header"}),
        );
        let numbers = json!({"model": "m", "speed_mm_s": 80, "force_n": 0.5, "parameters": [1, 2],
            "frequency_factor": 1.5, "level_rms": 0.25, "magnitude": [0.5, 0]});
        let refused = json!({"model": "m", "refused": true});
        write(
            "playing-conformance/cloth.json",
            json!({"asset": "cloth.htex", "frequency_hz": [20, 25], "cases": [numbers, refused]}),
        );
        folder
    }

    /// Answers as the files say.
    const HONEST: &str = r#"
found='"findings": [{"code": "BAND_INVALID", "pointer": "/band"}]'
case $1 in
assets)
    case $2 in
    */good.htex) echo '{"verdict": "valid", "findings": []}' ;;
    */large.htex) [ "$3" = '{"limits":{"values":1}}' ] || exit 9; echo '{"verdict": "invalid", '"$found"'}' ;;
    *) echo '{"verdict": "invalid", '"$found"'}' ;;
    esac ;;
baked)
    if grep -q '"seed":7' "$2" && grep -q '"render":4' "$2"; then
        echo '{"verdict": "valid", "findings": [], "values": {"samples_sha256": "aa", "integers_sha256": "bb"}}'
    else
        echo '{"verdict": "invalid", "findings": [{"code": "header", "pointer": ""}]}'
    fi ;;
playing)
    grep -q level_rms "$2" && exit 8
    echo '{"verdict": "valid", "values": {"cases": [{"parameters": [1, 2], "frequency_factor": 1.5,
        "level_rms": 0.250000001, "magnitude": [0.5, 0]}, null]}}' ;;
esac
"#;

    /// Runs a shell script as a reader.
    fn run_script(
        script: &str,
        change: impl Fn(&mut Options),
        arguments: &str,
    ) -> Result<Report, ConformanceError> {
        let files = files();
        let reader = files.path().join("the reader.sh");
        std::fs::write(&reader, script).unwrap();
        let line = format!("sh '{}' {arguments}", reader.display()).parse()?;
        let mut options = Options::new(files.path());
        change(&mut options);
        run(&line, &options, &|| false)
    }

    fn messages(report: &Report) -> Vec<&str> {
        report.differences.iter().map(|one| &one.message[..]).collect()
    }

    fn assets(options: &mut Options) {
        options.parts = vec![Part::Assets];
    }

    #[test]
    fn a_reader_that_answers_rightly_passes_everything_that_it_is_asked() {
        let two = |options: &mut Options| options.jobs = NonZero::new(2).unwrap();
        let report = run_script(HONEST, two, "{part} {file}").unwrap();
        assert_eq!(messages(&report), [""; 0]);
        assert!(report.passed);
        assert_eq!(report.runs, 5);
        let count = |class: Class, part: Part| {
            let row = report.matrix.rows.iter().find(|row| row.class == class).unwrap();
            row.counts.get(&part).map(|count| (count.passed, count.all))
        };
        assert_eq!(count(Class::Validator, Part::Assets), Some((2, 2)));
        assert_eq!(count(Class::Reader, Part::Baked), Some((2, 2)));
        assert_eq!(count(Class::Player, Part::Baked), Some((1, 1)));
        assert_eq!(count(Class::Player, Part::Playing), Some((2, 2)));
        assert_eq!(count(Class::Player, Part::Assets), None);
        let left: Vec<&str> = report.left_out.iter().map(|one| &one.file[..]).collect();
        assert_eq!(left, ["large.htex"]);
        let markdown = "| class | assets | baked | playing |\n|---|---|---|---|\n\
            | validator | 2 of 2 | 2 of 2 | – |\n| reader | 2 of 2 | 2 of 2 | – |\n\
            | player | – | 1 of 1 | 2 of 2 |\n";
        assert_eq!(report.to_markdown(), markdown);
        assert!(report.to_badge().contains("htex conformance: 11 passed"));
        let report = run_script(HONEST, |_| {}, "{part} {file} {options}").unwrap();
        assert_eq!((report.passed, report.runs, report.left_out.len()), (true, 6, 0));
    }

    #[test]
    fn a_reader_that_answers_wrongly_is_told_what_differs() {
        let lies =
            "echo '{\"verdict\": \"valid\", \"findings\": [], \"values\": {\"cases\": [null, 1]}}'";
        let report = run_script(lies, |_| {}, "{file}").unwrap();
        assert!(!report.passed);
        let expected = [
            "findings: no finding instead of BAND_INVALID at /band",
            "verdict: valid instead of invalid",
            "findings: no finding instead of header",
            "verdict: valid instead of invalid",
            "values: samples_sha256 is missing",
            "values: integers_sha256 is missing",
            "m at 80 mm/s, 0.5 N: it is refused, and has to be played",
            "m without a motion: it is played, and has to be refused",
        ];
        assert_eq!(messages(&report), expected);
        assert!(report.to_badge().contains("htex conformance: 4 of 11"), "{}", report.to_badge());
        let only = |options: &mut Options| options.classes = vec![Class::Reader];
        let report = run_script(lies, only, "{file}").unwrap();
        assert_eq!(report.total(), super::super::Count { passed: 2, all: 4 });
        let near = HONEST.replace("0.250000001", "0.250000003");
        let report = run_script(&near, |_| {}, "{part} {file}").unwrap();
        let far = "m at 80 mm/s, 0.5 N: level_rms: 0.250000003 instead of 0.25";
        assert_eq!(messages(&report), [far]);
    }

    #[test]
    fn a_run_that_fails_is_named() {
        for (script, expected) in [
            ("echo hello", "it printed no JSON object (expected value at line 1 column 1): hello"),
            ("echo '[1]'", "it printed no JSON object: [1]"),
            ("", "it printed nothing"),
            ("printf '\\377'", "it printed no UTF-8"),
            (
                "echo '{\"verdict\": \"maybe\"}'",
                "its answer is wrong: unknown variant `maybe`, expected `valid` or `invalid`",
            ),
            ("echo '{}'", "its answer is wrong: missing field `verdict`"),
            ("echo oh no >&2; exit 3", "it ended with exit status: 3; its last line: oh no"),
            ("kill -9 $$", "it ended with signal: 9 (SIGKILL)"),
            ("cat /dev/zero", "it printed more than 16 MiB, and was stopped"),
        ] {
            let report = run_script(script, assets, "{file}").unwrap();
            assert_eq!(messages(&report), [expected; 2], "{script}");
            assert_eq!(report.total().passed, 0, "{script}");
        }
    }

    /// After a run, no reader is left, not even one that hangs, and no process that a reader
    /// started is left.
    #[test]
    fn no_process_is_left_behind() {
        let left = tempfile::tempdir().unwrap();
        let file = left.path().join("left");
        let start = Instant::now();
        let behind = format!("(sleep 2; echo left >'{}') &\n", file.display());
        let short = |options: &mut Options| {
            assets(options);
            options.time_limit = Duration::from_millis(300);
        };
        let report = run_script(&format!("{behind}sleep 60"), short, "{file}").unwrap();
        assert_eq!(messages(&report), ["it did not end within 0.3 s, and was stopped"; 2]);
        let report = run_script(&format!("{behind}{HONEST}"), assets, "{part} {file}").unwrap();
        assert!(report.passed, "{report}");
        assert!(start.elapsed() < Duration::from_secs(30));
        std::thread::sleep(Duration::from_millis(2500));
        assert!(!file.exists());
    }

    #[test]
    fn a_run_that_cannot_begin_or_is_stopped_is_an_error() {
        let files = files();
        let absent: CommandLine = "/no/such/reader {file}".parse().unwrap();
        let error = run(&absent, &Options::new(files.path()), &|| false).unwrap_err();
        assert!(error.to_string().contains("cannot be started"), "{error}");
        let start = Instant::now();
        let stop = || start.elapsed() > Duration::from_millis(100);
        let error =
            run(&"sh -c 'sleep 60' {file}".parse().unwrap(), &Options::new(files.path()), &stop);
        assert!(matches!(error, Err(ConformanceError::Stopped { done: 0, all: 5 })), "{error:?}");
        assert!(start.elapsed() < Duration::from_secs(30));
        let empty = tempfile::tempdir().unwrap();
        let error = run(&absent, &Options::new(empty.path()), &|| false).unwrap_err();
        assert!(error.to_string().contains("there are no conformance files"), "{error}");
    }
}
