//! Compiling in a process of its own, which is stopped where it takes too much.

use std::io::{Read, Write};
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

use super::compile::{Effort, here};
use super::engine::engine;
use crate::WasmLimits;

/// The first byte of an answer: machine code, or a sentence.
const COMPILED: u8 = 0;
const REFUSED: u8 = 1;

/// Sends a module to a process that calls [`serve`], and answers its machine code.
pub(super) fn compile(
    (program, arguments): (&Path, &[String]),
    module: &[u8],
    limits: &WasmLimits,
    effort: Effort,
    time: Duration,
) -> Result<Vec<u8>, String> {
    let failed = |e: std::io::Error| format!("cannot start {} to compile: {e}", program.display());
    let mut child = Command::new(program)
        .args(arguments)
        .args(Request::new(limits, effort, time).words())
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .map_err(failed)?;
    let (stdin, stdout) = (child.stdin.take(), child.stdout.take());
    let (answer, answered) = mpsc::channel();
    let result = std::thread::scope(|scope| {
        // A process that ends early is found by its answer.
        scope.spawn(move || stdin.map(|mut pipe| pipe.write_all(module)));
        scope.spawn(move || {
            let mut bytes = Vec::new();
            let read = stdout.map(|mut pipe| pipe.read_to_end(&mut bytes));
            let _ = answer.send(read.map(|_| bytes));
        });
        let result = answered.recv_timeout(time);
        // Its pipes end with it, and so do the threads.
        let _ = child.kill();
        let _ = child.wait();
        result
    });
    match result {
        Ok(Some(bytes)) => match bytes.split_first() {
            Some((&COMPILED, artifact)) => Ok(artifact.to_vec()),
            Some((_, sentence)) => Err(String::from_utf8_lossy(sentence).into_owned()),
            None => Err(format!(
                "the compiler ended without an answer: the module needs more than {} bytes to compile, or is made to \
                 break it",
                limits.compile_bytes
            )),
        },
        Err(RecvTimeoutError::Timeout) => Err(format!(
            "the module took longer than {} ms to compile and was given up",
            time.as_millis()
        )),
        Ok(None) | Err(RecvTimeoutError::Disconnected) => {
            Err("the compiler's process has no output".to_owned())
        }
    }
}

/// Compiles the module of standard input to standard output, as [`WasmCompiler::Program`](crate::WasmCompiler) asks
/// with these arguments, behind its own. On Unix it bounds its memory and its processor time first.
///
/// # Errors
/// When the arguments are not those of a host of this version, or a pipe breaks.
pub fn serve_compiler(arguments: &[String]) -> Result<(), String> {
    let request =
        Request::read(arguments).ok_or("this is called by a host, to compile a module")?;
    request.bound_this_process()?;
    let mut module = Vec::new();
    let pipe = |e: std::io::Error| e.to_string();
    std::io::stdin().read_to_end(&mut module).map_err(pipe)?;
    let (first, answer) = match request.compile(&module) {
        Ok(artifact) => (COMPILED, artifact),
        Err(sentence) => (REFUSED, sentence.into_bytes()),
    };
    let mut out = std::io::stdout().lock();
    out.write_all(&[first]).map_err(pipe)?;
    out.write_all(&answer).map_err(pipe)?;
    out.flush().map_err(pipe)
}

/// What the compiler has to know beside the module.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Request {
    quick: bool,
    fuel: bool,
    stack_bytes: usize,
    memory_bytes: usize,
    time_s: u64,
}

impl Request {
    fn new(limits: &WasmLimits, effort: Effort, time: Duration) -> Self {
        Self {
            quick: effort == Effort::Quick,
            fuel: limits.fuel.is_some(),
            stack_bytes: limits.stack_bytes,
            memory_bytes: limits.compile_bytes,
            time_s: time.as_secs() + 1,
        }
    }

    fn words(self) -> [String; 5] {
        [
            self.quick.to_string(),
            self.fuel.to_string(),
            self.stack_bytes.to_string(),
            self.memory_bytes.to_string(),
            self.time_s.to_string(),
        ]
    }

    fn read(words: &[String]) -> Option<Self> {
        let [quick, fuel, stack_bytes, memory_bytes, time_s] = words else {
            return None;
        };
        Some(Self {
            quick: quick.parse().ok()?,
            fuel: fuel.parse().ok()?,
            stack_bytes: stack_bytes.parse().ok()?,
            memory_bytes: memory_bytes.parse().ok()?,
            time_s: time_s.parse().ok()?,
        })
    }

    fn compile(self, module: &[u8]) -> Result<Vec<u8>, String> {
        let limits = WasmLimits {
            stack_bytes: self.stack_bytes,
            fuel: self.fuel.then_some(1),
            ..WasmLimits::default()
        };
        let effort = if self.quick {
            Effort::Quick
        } else {
            Effort::Optimised
        };
        let module = here(&engine(&limits, effort)?, module)?;
        module.serialize().map_err(|e| format!("{e:#}"))
    }

    /// What a process goes over ends it, and leaves no dump of its memory.
    #[cfg(unix)]
    fn bound_this_process(self) -> Result<(), String> {
        use rustix::process::{Resource, Rlimit, setrlimit};
        let bounds = [
            (Resource::Data, self.memory_bytes as u64),
            (Resource::Cpu, self.time_s),
            (Resource::Core, 0),
        ];
        for (resource, most) in bounds {
            let most = Some(most);
            setrlimit(
                resource,
                Rlimit {
                    current: most,
                    maximum: most,
                },
            )
            .map_err(|e| format!("cannot bound the compiler's process: {e}"))?;
        }
        Ok(())
    }

    #[cfg(not(unix))]
    fn bound_this_process(self) -> Result<(), String> {
        Ok(())
    }
}
