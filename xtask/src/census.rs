//! Measures the size of the sources: `cargo xtask census`.
//!
//! Counts code in the tokens of a Rust parser, so that layout and comments do not change the count.
//! Other rows count lines, packages, error types and public names. A file is a test if it lies in a
//! folder `tests`, `benches` or `fuzz`, or is named `tests.rs`. The part of a file after
//! `#[cfg(test)] mod` also counts as a test.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};
use proc_macro2::{TokenStream, TokenTree};
use quote::ToTokens;
use syn::visit::{self, Visit};
use syn::visit_mut::{self, VisitMut};

use crate::places::workspace;

/// One measure of the sources.
struct Row {
    what: &'static str,
    number: String,
}

/// Prints the census.
pub fn census(list: bool) -> Result<()> {
    let sources = sources()?;
    let packages = Packages::read()?;
    for Row { what, number } in rows(&sources, &packages, list)? {
        println!("{number:>10}  {what}");
    }
    Ok(())
}

fn rows(sources: &[Source], packages: &Packages, list: bool) -> Result<Vec<Row>> {
    let code = || sources.iter().filter(|source| !source.is_test);
    let lines: usize = sources.iter().map(|source| source.code_lines).sum();
    let tests: usize = sources.iter().map(|source| source.test_lines).sum();
    let whys: usize = code().map(|source| source.why_lines).sum();
    let errors: BTreeSet<&str> = code().flat_map(|source| names(&source.errors)).collect();
    let contexts: BTreeSet<&str> = code().flat_map(|source| names(&source.contexts)).collect();
    let unused = unused(sources, packages);
    let row = |what, number: usize| Row { what, number: number.to_string() };
    let mut rows = vec![
        row(
            "tokens of Rust outside comments, attributes and tests",
            code().map(|s| s.tokens).sum(),
        ),
        row("lines of Rust outside tests", lines),
        row("lines of Rust in tests", tests),
        row("packages", packages.ours.len()),
        row("crates that htex-cli needs to be published", packages.needed("htex-cli").len()),
        row("error types", errors.len()),
        row("traits for Result, which attach context", contexts.len()),
        row(
            "`pub` items of internal crates that no other crate and no public signature names",
            unused.len(),
        ),
        row("names at the root of htex", root_names(packages)?),
    ];
    let share = 100.0 * whys as f64 / lines.max(1) as f64;
    rows.push(Row {
        what: "% of lines outside tests: comments in the code (`//`)",
        number: format!("{share:.2}"),
    });
    if list {
        println!("{errors:#?}\n{contexts:#?}\n{unused:#?}");
    }
    Ok(rows)
}

fn names(all: &[String]) -> impl Iterator<Item = &str> {
    all.iter().map(String::as_str)
}

/// The contents of one file.
struct Source {
    path: PathBuf,
    is_test: bool,
    tokens: usize,
    code_lines: usize,
    test_lines: usize,
    why_lines: usize,
    errors: Vec<String>,
    contexts: Vec<String>,
    public: Vec<String>,
    /// Names in public signatures and fields.
    interface: BTreeSet<String>,
    /// Every identifier of the file.
    words: BTreeSet<String>,
}

/// The Rust sources of this repository.
fn sources() -> Result<Vec<Source>> {
    let listed =
        Command::new("git").current_dir(workspace()).args(["ls-files", "*.rs"]).output()?;
    ensure!(listed.status.success(), "git ls-files failed");
    let names = String::from_utf8(listed.stdout)?;
    // The templates of new plugins contain placeholders, which no parser accepts.
    let names = names.lines().filter(|name| !name.contains("/templates/"));
    names.map(|name| source(Path::new(name))).collect()
}

fn source(path: &Path) -> Result<Source> {
    let text = fs_err::read_to_string(workspace().join(path))?;
    let mut file = syn::parse_file(&text).with_context(|| path.display().to_string())?;
    let is_test_part =
        |part: &std::ffi::OsStr| ["tests", "benches", "fuzz"].iter().any(|name| part == *name);
    let is_test = path.iter().any(is_test_part) || path.ends_with("tests.rs");
    let words = words(file.to_token_stream());
    let mut found = FileCount::default();
    found.visit_file(&file);
    let test_lines = if is_test { text.lines().count() } else { found.test_lines };
    WithoutTests.visit_file_mut(&mut file);
    // The file is visited twice: first to count the lines of tests, then, without the tests, to
    // count names.
    let mut kept = FileCount::default();
    kept.visit_file(&file);
    Ok(Source {
        path: path.to_owned(),
        is_test,
        tokens: count(file.to_token_stream()),
        code_lines: text.lines().count() - test_lines,
        test_lines,
        why_lines: text.lines().filter(|line| is_why(line)).count(),
        errors: kept.errors,
        contexts: kept.contexts,
        public: kept.public,
        interface: kept.interface,
        words,
    })
}

fn is_why(line: &str) -> bool {
    let line = line.trim_start();
    line.starts_with("// ") && !line.starts_with("// SAFETY")
}

/// Counts tokens. A pair of brackets counts as two.
fn count(tokens: TokenStream) -> usize {
    let size = |token| match token {
        TokenTree::Group(group) => 2 + count(group.stream()),
        _ => 1,
    };
    tokens.into_iter().map(size).sum()
}

fn words(tokens: TokenStream) -> BTreeSet<String> {
    let mut all = BTreeSet::new();
    collect(tokens, &mut all);
    all
}

fn collect(tokens: TokenStream, all: &mut BTreeSet<String>) {
    for token in tokens {
        match token {
            TokenTree::Group(group) => collect(group.stream(), all),
            TokenTree::Ident(ident) => drop(all.insert(ident.to_string())),
            // Examples in the documentation are also code.
            TokenTree::Literal(literal) => {
                let text = literal.to_string();
                let parts = text.split(|c: char| !c.is_alphanumeric() && c != '_');
                all.extend(parts.filter(|part| !part.is_empty()).map(str::to_owned));
            }
            TokenTree::Punct(_) => {}
        }
    }
}

fn is_test_item(attributes: &[syn::Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        let text = attribute.meta.to_token_stream().to_string();
        text == "test" || text.replace(' ', "").starts_with("cfg(test")
    })
}

/// Removes tests and attributes.
struct WithoutTests;

impl VisitMut for WithoutTests {
    fn visit_file_mut(&mut self, file: &mut syn::File) {
        file.items.retain(|item| !is_test_item(attributes(item)));
        visit_mut::visit_file_mut(self, file);
    }

    fn visit_item_mod_mut(&mut self, module: &mut syn::ItemMod) {
        if let Some((_, items)) = &mut module.content {
            items.retain(|item| !is_test_item(attributes(item)));
        }
        visit_mut::visit_item_mod_mut(self, module);
    }

    fn visit_attributes_mut(&mut self, attributes: &mut Vec<syn::Attribute>) {
        // The derives of a type are needed to find the error types.
        attributes.retain(|attribute| attribute.path().is_ident("derive"));
    }
}

fn attributes(item: &syn::Item) -> &[syn::Attribute] {
    match item {
        syn::Item::Const(item) => &item.attrs,
        syn::Item::Enum(item) => &item.attrs,
        syn::Item::Fn(item) => &item.attrs,
        syn::Item::Impl(item) => &item.attrs,
        syn::Item::Mod(item) => &item.attrs,
        syn::Item::Static(item) => &item.attrs,
        syn::Item::Struct(item) => &item.attrs,
        syn::Item::Use(item) => &item.attrs,
        _ => &[],
    }
}

/// The counts of one file.
#[derive(Default)]
struct FileCount {
    test_lines: usize,
    errors: Vec<String>,
    contexts: Vec<String>,
    public: Vec<String>,
    /// Names in the types of public functions, fields, variants, constants and traits.
    interface: BTreeSet<String>,
}

impl FileCount {
    fn add(&mut self, visibility: &syn::Visibility, name: &syn::Ident, types: impl ToTokens) {
        if is_public(visibility) {
            self.public.push(name.to_string());
            collect(types.into_token_stream(), &mut self.interface);
        }
    }
}

fn is_public(visibility: &syn::Visibility) -> bool {
    matches!(visibility, syn::Visibility::Public(_))
}

/// Returns the types of the public fields.
fn public_fields(fields: &syn::Fields) -> TokenStream {
    let public = fields.iter().filter(|field| is_public(&field.vis));
    public.map(|field| field.ty.to_token_stream()).collect()
}

impl<'a> Visit<'a> for FileCount {
    fn visit_item(&mut self, item: &'a syn::Item) {
        if is_test_item(attributes(item)) {
            use syn::spanned::Spanned;
            let span = item.span();
            self.test_lines += span.end().line + 1 - span.start().line;
            return;
        }
        match item {
            syn::Item::Const(item) => self.add(&item.vis, &item.ident, &item.ty),
            syn::Item::Enum(item) => {
                let fields = item.variants.iter().map(|variant| variant.fields.to_token_stream());
                self.add(&item.vis, &item.ident, fields.collect::<TokenStream>());
            }
            syn::Item::Fn(item) => self.add(&item.vis, &item.sig.ident, &item.sig),
            syn::Item::Struct(item) => {
                self.add(&item.vis, &item.ident, public_fields(&item.fields));
            }
            syn::Item::Trait(item) => {
                let items = item.items.iter().map(ToTokens::to_token_stream);
                self.add(&item.vis, &item.ident, items.collect::<TokenStream>());
            }
            syn::Item::Type(item) => self.add(&item.vis, &item.ident, &item.ty),
            _ => {}
        }
        let derives = attributes(item).iter().any(|attribute| {
            attribute.path().is_ident("derive")
                && attribute.meta.to_token_stream().to_string().contains("Error")
        });
        let (syn::Item::Enum(syn::ItemEnum { ident, .. })
        | syn::Item::Struct(syn::ItemStruct { ident, .. })) = item
        else {
            return visit::visit_item(self, item);
        };
        if derives {
            self.errors.push(ident.to_string());
        }
        visit::visit_item(self, item);
    }

    fn visit_item_impl(&mut self, item: &'a syn::ItemImpl) {
        let last = |path: &syn::Path| path.segments.last().map(|segment| segment.ident.to_string());
        if let (Some((_, of, _)), syn::Type::Path(ours)) = (&item.trait_, &*item.self_ty) {
            match (last(of).as_deref(), last(&ours.path)) {
                (Some("Error"), Some(name)) => self.errors.push(name),
                (Some(of), Some(name)) if name == "Result" => self.contexts.push(of.to_owned()),
                _ => {}
            }
        }
        for part in &item.items {
            match part {
                syn::ImplItem::Fn(part) if is_public(&part.vis) || item.trait_.is_some() => {
                    collect(part.sig.to_token_stream(), &mut self.interface);
                }
                syn::ImplItem::Type(part) => {
                    collect(part.ty.to_token_stream(), &mut self.interface);
                }
                _ => {}
            }
        }
        visit::visit_item_impl(self, item);
    }
}

/// The packages of this workspace.
struct Packages {
    ours: BTreeMap<String, Package>,
}

struct Package {
    /// The package's folder in the workspace.
    folder: PathBuf,
    /// Packages of this workspace that the package needs outside tests.
    needs: Vec<String>,
}

/// Crates whose `pub` items are meant for users.
const FOR_USERS: [&str; 5] = ["htex", "htex-model", "htex-device", "htex-player", "htex-capi"];

impl Packages {
    fn read() -> Result<Self> {
        let arguments = ["metadata", "--no-deps", "--locked", "--format-version", "1"];
        let listed = Command::new("cargo").current_dir(workspace()).args(arguments).output()?;
        ensure!(listed.status.success(), "cargo metadata failed");
        let all: serde_json::Value = serde_json::from_slice(&listed.stdout)?;
        let text = |value: &serde_json::Value| value.as_str().unwrap_or_default().to_owned();
        let list = |value: &serde_json::Value| value.as_array().cloned().unwrap_or_default();
        let root = PathBuf::from(text(&all["workspace_root"]));
        let package = |package: &serde_json::Value| {
            let needs = list(&package["dependencies"]);
            let ours =
                needs.iter().filter(|need| need["path"].is_string() && need["kind"] != "dev");
            let manifest = PathBuf::from(text(&package["manifest_path"]));
            let folder = manifest.parent().and_then(|folder| folder.strip_prefix(&root).ok());
            let folder = folder.map_or_else(PathBuf::new, Path::to_owned);
            let needs = ours.map(|need| text(&need["name"])).collect();
            (text(&package["name"]), Package { folder, needs })
        };
        Ok(Self { ours: list(&all["packages"]).iter().map(package).collect() })
    }

    /// Returns a package and all packages of this workspace that it needs.
    fn needed(&self, name: &str) -> BTreeSet<String> {
        let mut all = BTreeSet::new();
        let mut left = vec![name.to_owned()];
        while let Some(name) = left.pop() {
            let needs = self.ours.get(&name).map_or(&[][..], |package| &package.needs);
            if all.insert(name) {
                left.extend(needs.iter().cloned());
            }
        }
        all
    }

    /// Returns the package in whose folder a file lies.
    fn package(&self, path: &Path) -> Option<&str> {
        let holds = |(_, package): &(&String, &Package)| path.starts_with(&package.folder);
        let depth = |(_, package): &(&String, &Package)| package.folder.iter().count();
        self.ours.iter().filter(holds).max_by_key(depth).map(|(name, _)| name.as_str())
    }
}

/// Returns the `pub` items of internal crates that need not be public, as `crate::item`. The name
/// of such an item occurs in no other crate, and in no public signature or field of its own crate.
fn unused(sources: &[Source], packages: &Packages) -> Vec<String> {
    // Integration tests count as separate crates.
    let mut words: BTreeMap<&str, BTreeSet<(&str, bool)>> = BTreeMap::new();
    for source in sources {
        let package = packages.package(&source.path).unwrap_or_default();
        for word in &source.words {
            words.entry(word).or_default().insert((package, source.is_test));
        }
    }
    let mut interfaces: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for source in sources {
        let package = packages.package(&source.path).unwrap_or_default();
        let names = source.interface.iter().map(String::as_str);
        interfaces.entry(package).or_default().extend(names);
    }
    let mut unused = Vec::new();
    for source in sources.iter().filter(|source| !source.is_test) {
        let package = packages.package(&source.path).unwrap_or_default();
        let interface = &interfaces[package];
        let is_internal = !FOR_USERS.contains(&package) && !package.is_empty();
        let is_unused = |name: &&String| {
            let is_named = words.get(name.as_str()).is_some_and(|packages| packages.len() > 1);
            !is_named && !interface.contains(name.as_str())
        };
        if is_internal {
            unused.extend(
                source.public.iter().filter(is_unused).map(|name| format!("{package}::{name}")),
            );
        }
    }
    unused
}

/// Counts the names that `use htex::*` imports: items and re-exports. A wildcard re-export counts
/// as all names of the crate that it re-exports.
fn root_names(packages: &Packages) -> Result<usize> {
    let mut names = BTreeSet::new();
    root_names_of("htex", packages, &mut names)?;
    Ok(names.len())
}

fn root_names_of(package: &str, packages: &Packages, names: &mut BTreeSet<String>) -> Result<()> {
    let folder = &packages.ours.get(package).with_context(|| package.to_owned())?.folder;
    let file =
        syn::parse_file(&fs_err::read_to_string(workspace().join(folder).join("src/lib.rs"))?)?;
    for item in &file.items {
        match item {
            syn::Item::Use(item) if matches!(item.vis, syn::Visibility::Public(_)) => {
                let mut found = (Vec::new(), Vec::new());
                used(&item.tree, "", &mut found);
                names.extend(found.0);
                for wildcard in found.1 {
                    root_names_of(&wildcard.replace('_', "-"), packages, names)?;
                }
            }
            syn::Item::Mod(item) if matches!(item.vis, syn::Visibility::Public(_)) => {
                names.insert(item.ident.to_string());
            }
            _ => {}
        }
    }
    Ok(())
}

/// Adds the names that a `use` tree imports, and the crates that it imports with wildcards.
fn used(tree: &syn::UseTree, before: &str, found: &mut (Vec<String>, Vec<String>)) {
    match tree {
        syn::UseTree::Path(path) => used(&path.tree, &path.ident.to_string(), found),
        syn::UseTree::Name(name) => found.0.push(name.ident.to_string()),
        syn::UseTree::Rename(rename) => found.0.push(rename.rename.to_string()),
        syn::UseTree::Glob(_) => found.1.push(before.to_owned()),
        syn::UseTree::Group(group) => group.items.iter().for_each(|tree| used(tree, before, found)),
    }
}
