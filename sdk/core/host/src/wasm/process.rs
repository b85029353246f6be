//! Compilation in a separate process. The host stops this process if compilation exceeds the limits
//! of time or memory.

use std::io::{Read, Write};
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

use super::compile_error::{CompileError, CompilerError};
use super::engine::{Effort, engine, here};
use crate::{WasmEngine, WasmLimits};

/// The first byte of a reply. It says whether machine code or an error message follows.
const COMPILED: u8 = 0;
const REFUSED: u8 = 1;

/// Sends a module to a process that calls [`serve_compiler`], and returns the machine code.
pub(super) fn compile(
    (program, arguments): (&Path, &[String]),
    module: &[u8],
    limits: &WasmLimits,
    effort: Effort,
    time: Duration,
) -> Result<Vec<u8>, CompileError> {
    let failed = |error: std::io::Error| CompileError::Start {
        program: program.display().to_string(),
        what: error.to_string(),
    };
    let mut child = Command::new(program)
        .args(arguments)
        .args(Request::new(limits, effort, time).words())
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .map_err(failed)?;
    let (stdin, stdout) = (child.stdin.take(), child.stdout.take());
    let (sender, receiver) = mpsc::channel();
    let result = std::thread::scope(|scope| {
        // An error of writing is ignored. If the process ends early, the missing reply shows this.
        scope.spawn(move || stdin.map(|mut pipe| pipe.write_all(module)));
        scope.spawn(move || {
            let mut bytes = Vec::new();
            let read = stdout.map(|mut pipe| pipe.read_to_end(&mut bytes));
            let _ = sender.send(read.map(|_| bytes));
        });
        let result = receiver.recv_timeout(time);
        // The end of the process closes its pipes, which ends the threads.
        let _ = child.kill();
        let _ = child.wait();
        result
    });
    match result {
        Ok(Some(bytes)) => match bytes.split_first() {
            Some((&COMPILED, artifact)) => Ok(artifact.to_vec()),
            Some((_, message)) => {
                Err(CompileError::Engine { what: String::from_utf8_lossy(message).into_owned() })
            }
            None => Err(CompileError::NoReply { bytes: limits.compile_bytes }),
        },
        Err(RecvTimeoutError::Timeout) => Err(CompileError::Timeout { ms: time.as_millis() }),
        Ok(None) | Err(RecvTimeoutError::Disconnected) => Err(CompileError::NoOutput),
    }
}

/// Reads a module from standard input, compiles it, and writes the result to standard output. A
/// host starts the program that [`WasmCompiler::Program`](crate::WasmCompiler) names. The host
/// passes the arguments of that variant first, and then its own arguments. `arguments` contains
/// only the host's own arguments. On Unix, the process first limits its memory and its processor
/// time.
///
/// ```no_run
/// let arguments: Vec<String> = std::env::args().skip(1).collect();
/// if let Some(("compile", limits)) = arguments.split_first().map(|(first, rest)| (&first[..], rest)) {
///     htex_host::serve_compiler(limits)?;
/// }
/// # Ok::<(), htex_host::CompilerError>(())
/// ```
///
/// # Errors
/// Returns an error if the arguments do not come from a host of this version, if the limits cannot
/// be set, or if a pipe breaks.
pub fn serve_compiler(arguments: &[String]) -> Result<(), CompilerError> {
    let request = Request::read(arguments).ok_or(CompilerError::Arguments)?;
    request.limit_this_process()?;
    let mut module = Vec::new();
    std::io::stdin().read_to_end(&mut module)?;
    let (first, reply) = match request.compile(&module) {
        Ok(artifact) => (COMPILED, artifact),
        Err(error) => (REFUSED, error.to_string().into_bytes()),
    };
    let mut out = std::io::stdout().lock();
    out.write_all(&[first])?;
    out.write_all(&reply)?;
    Ok(out.flush()?)
}

/// The arguments of the compiler.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Request {
    quick: bool,
    fuel: bool,
    signals: bool,
    stack_bytes: usize,
    memory_bytes: usize,
    time_s: u64,
}

impl Request {
    fn new(limits: &WasmLimits, effort: Effort, time: Duration) -> Self {
        Self {
            quick: effort == Effort::Quick,
            fuel: limits.fuel.is_some(),
            signals: limits.engine == WasmEngine::Signals,
            stack_bytes: limits.stack_bytes,
            memory_bytes: limits.compile_bytes,
            // The operating system takes the limit in whole seconds, so it is rounded up. The
            // host's own timer is exact.
            time_s: time.as_secs() + 1,
        }
    }

    fn words(self) -> [String; 6] {
        [
            self.quick.to_string(),
            self.fuel.to_string(),
            self.signals.to_string(),
            self.stack_bytes.to_string(),
            self.memory_bytes.to_string(),
            self.time_s.to_string(),
        ]
    }

    fn read(words: &[String]) -> Option<Self> {
        let [quick, fuel, signals, stack_bytes, memory_bytes, time_s] = words else {
            return None;
        };
        Some(Self {
            quick: quick.parse().ok()?,
            fuel: fuel.parse().ok()?,
            signals: signals.parse().ok()?,
            stack_bytes: stack_bytes.parse().ok()?,
            memory_bytes: memory_bytes.parse().ok()?,
            time_s: time_s.parse().ok()?,
        })
    }

    fn compile(self, module: &[u8]) -> Result<Vec<u8>, CompileError> {
        let limits = WasmLimits {
            stack_bytes: self.stack_bytes,
            // The machine code depends on whether instructions are counted, but not on the limit of
            // their number.
            fuel: self.fuel.then_some(1),
            engine: if self.signals { WasmEngine::Signals } else { WasmEngine::Checked },
            ..WasmLimits::default()
        };
        let effort = if self.quick { Effort::Quick } else { Effort::Optimised };
        let module = here(&engine(&limits, effort)?, module)?;
        Ok(module.serialize()?)
    }

    /// Sets limits of time and memory. If this process exceeds them, it ends without a core dump.
    #[cfg(unix)]
    fn limit_this_process(self) -> Result<(), CompilerError> {
        use rustix::process::{Resource, Rlimit, setrlimit};
        let bounds = [
            (Resource::Data, self.memory_bytes as u64),
            (Resource::Cpu, self.time_s),
            (Resource::Core, 0),
        ];
        for (resource, most) in bounds {
            let most = Some(most);
            setrlimit(resource, Rlimit { current: most, maximum: most })
                .map_err(|error| CompilerError::Limits(error.into()))?;
        }
        Ok(())
    }

    #[cfg(not(unix))]
    fn limit_this_process(self) -> Result<(), CompilerError> {
        Ok(())
    }
}
