//! Programs that link to the library.

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use xtask::needs::{self, Need};

/// An asset with one condition.
pub fn asset() -> PathBuf {
    workspace().join("examples/scenes/vinyl.htex")
}

fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../..")
}

fn capi(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(file)
}

/// A language and its compiler.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Language {
    C,
    Clang,
    Cxx,
    Csharp,
}

impl Language {
    pub const ALL: [Self; 4] = [Self::C, Self::Clang, Self::Cxx, Self::Csharp];

    fn compiler(self) -> (&'static str, &'static Need) {
        match self {
            Self::C => ("cc", &needs::CC),
            Self::Clang => ("clang", &needs::CLANG),
            Self::Cxx => ("c++", &needs::CXX),
            Self::Csharp => ("mcs", &needs::MONO),
        }
    }

    fn source(self) -> &'static str {
        match self {
            Self::C | Self::Clang => "main.c",
            Self::Cxx => "main.cpp",
            Self::Csharp => "Main.cs",
        }
    }

    pub fn example(self) -> PathBuf {
        capi(match self {
            Self::C | Self::Clang => "examples/play.c",
            Self::Cxx => "examples/play.cpp",
            Self::Csharp => "examples/Play.cs",
        })
    }

    /// The program in this language from the README.
    pub fn in_readme(self, readme: &str) -> String {
        let fence = match self {
            Self::C | Self::Clang => "```c\n",
            Self::Cxx => "```cpp\n",
            Self::Csharp => "```csharp\n",
        };
        let (_, rest) = readme.split_once(fence).unwrap();
        let (code, _) = rest.split_once("```").unwrap();
        match self {
            Self::Csharp => format!("static class Program {{ static void Main() {{\n{code}}} }}\n"),
            _ => code.to_owned(),
        }
    }

    /// Parses a printed sample; C and C++ print it as a hexadecimal float.
    pub fn number(self, text: &str) -> f32 {
        match self {
            Self::Csharp => text.parse().unwrap(),
            _ => hexadecimal(text),
        }
    }
}

fn hexadecimal(text: &str) -> f32 {
    let (sign, text) = match text.strip_prefix('-') {
        Some(rest) => (-1.0, rest),
        None => (1.0, text),
    };
    let (digits, exponent) = text.strip_prefix("0x").unwrap().split_once('p').unwrap();
    let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
    let mantissa = u64::from_str_radix(&format!("{whole}{fraction}"), 16).unwrap() as f64;
    let exponent: i32 = exponent.parse().unwrap();
    (sign * mantissa * 2f64.powi(exponent - 4 * fraction.len() as i32)) as f32
}

/// A folder with the library and a program.
pub struct Project {
    language: Language,
    folder: PathBuf,
}

impl Project {
    /// Makes an empty project; `None` without a compiler for the language.
    pub fn new(language: Language, name: &str) -> Option<Self> {
        let (compiler, need) = language.compiler();
        let there = Command::new(compiler).arg("--version").output().is_ok();
        if !need.met(there) {
            return None;
        }
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}-{language:?}"));
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).unwrap();
        // The second name is the one that the library states for itself. Copies would take 2 GB in
        // all.
        for name in ["libhtex.so", "libhtex.so.1"] {
            fs::hard_link(library(), folder.join(name)).unwrap();
        }
        Some(Self { language, folder })
    }

    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Builds a program. A warning is an error.
    pub fn build(&self, source: &str) -> PathBuf {
        self.build_with(source, &[])
    }

    /// As [`Self::build`], with further arguments for the compiler.
    pub fn build_with(&self, source: &str, more: &[&str]) -> PathBuf {
        let file = self.folder.join(self.language.source());
        fs::write(&file, source).unwrap();
        let program = self.folder.join("program.exe");
        let mut compiler = Command::new(self.language.compiler().0);
        match self.language {
            Language::Csharp => compiler
                .args(["-warnaserror", "-langversion:7"])
                .arg(format!("-out:{}", program.display()))
                .arg(&file)
                .arg(capi("unity/Runtime/Htex.cs")),
            native => compiler
                .args(["-O1", "-Wall", "-Wextra", "-Werror", "-pedantic"])
                .arg(if native == Language::Cxx { "-std=c++17" } else { "-std=c11" })
                .arg(&file)
                .arg("-I")
                .arg(capi("include"))
                .arg("-L")
                .arg(&self.folder)
                .args(["-lhtex", "-lm", "-o"])
                .arg(&program),
        };
        let built = compiler.args(more).output().unwrap();
        let errors = String::from_utf8_lossy(&built.stderr);
        assert!(built.status.success(), "{compiler:?}: {errors}");
        program
    }

    /// Whether a program builds with these compiler arguments.
    pub fn builds(&self, arguments: &[&str]) -> bool {
        let file = self.folder.join("empty.c");
        fs::write(&file, "int main(void) { return 0; }\n").unwrap();
        let mut compiler = Command::new(self.language.compiler().0);
        compiler.args(arguments).arg(&file).arg("-o").arg(self.folder.join("empty"));
        compiler.output().is_ok_and(|built| built.status.success())
    }

    pub fn run(&self, program: &Path, arguments: &[&OsStr]) -> Output {
        let under: &[&str] = match self.language {
            Language::Csharp => &["mono"],
            _ => &[],
        };
        self.run_under(under, program, arguments)
    }

    /// Runs a program under another one, such as valgrind, with its arguments.
    pub fn run_under(&self, under: &[&str], program: &Path, arguments: &[&OsStr]) -> Output {
        let mut command = match under {
            [] => Command::new(program),
            [first, rest @ ..] => {
                let mut command = Command::new(first);
                command.args(rest).arg(program);
                command
            }
        };
        command.args(arguments).current_dir(&self.folder);
        command.env("LD_LIBRARY_PATH", &self.folder);
        command.output().unwrap()
    }
}

/// The shared library that cargo built for these tests.
fn library() -> PathBuf {
    let tests = std::env::current_exe().unwrap();
    let built = tests.parent().unwrap();
    built.join("libhtex_c.so")
}

/// Builds and runs a program in C under valgrind, and with the sanitizers of gcc and clang: `run`
/// is given a project, what to run the program under, and flags of the compiler.
pub fn clean(name: &str, leaks: &str, run: impl Fn(&Project, &[&str], &[&str])) {
    let valgrind = Command::new("valgrind").arg("--version").output().is_ok();
    let project = Project::new(Language::C, &format!("{name}_valgrind"));
    if let Some(project) = project.filter(|_| needs::VALGRIND.met(valgrind)) {
        let leaks = format!("--errors-for-leak-kinds={leaks}");
        let under = ["valgrind", "--quiet", "--error-exitcode=9", "--leak-check=full", &leaks];
        run(&project, &under, &[]);
    }
    let flags = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all"];
    for language in [Language::C, Language::Clang] {
        let project = Project::new(language, &format!("{name}_sanitized"));
        let met = |project: &Project| needs::SANITIZERS.met(project.builds(&flags));
        if let Some(project) = project.filter(met) {
            run(&project, &[], &flags);
        }
    }
}
