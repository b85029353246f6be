//! The `.meta` files of the Unity package: the GUID of each file and folder, and how Unity imports
//! it.
//!
//! A GUID is derived from the path, so that it never changes: users' scenes refer to files by GUID.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use sha2::{Digest, Sha256};

/// What Unity writes at the end of each importer.
const END: &str = "  userData: \n  assetBundleName: \n  assetBundleVariant: \n";

/// Where a library is used.
pub struct Plugin {
    /// Path in the package. Git contains only its `.meta` file.
    pub path: &'static str,
    /// The operating system and processor of the editors that load it.
    editor: Option<(&'static str, &'static str)>,
    /// Group and name of the platform.
    platform: (&'static str, &'static str),
    settings: &'static [&'static str],
}

pub const PLUGINS: [Plugin; 5] = [
    Plugin {
        path: "Plugins/Linux/x86_64/libhtex.so",
        editor: Some(("Linux", "x86_64")),
        platform: ("Standalone", "Linux64"),
        settings: &["CPU: x86_64"],
    },
    Plugin {
        path: "Plugins/Windows/x86_64/htex.dll",
        editor: Some(("Windows", "x86_64")),
        platform: ("Standalone", "Win64"),
        settings: &["CPU: x86_64"],
    },
    Plugin {
        path: "Plugins/macOS/libhtex.dylib",
        editor: Some(("OSX", "ARM64")),
        platform: ("Standalone", "OSXUniversal"),
        settings: &["CPU: ARM64"],
    },
    Plugin {
        path: "Plugins/Android/arm64-v8a/libhtex.so",
        editor: None,
        platform: ("Android", "Android"),
        settings: &["CPU: ARM64"],
    },
    Plugin {
        path: "Plugins/iOS/libhtex.a",
        editor: None,
        platform: ("iPhone", "iOS"),
        settings: &[
            "AddToEmbeddedBinaries: false",
            "CPU: ARM64",
            "CompileFlags: ",
            "FrameworkDependencies: ",
        ],
    },
];

/// The platforms that a library excludes in its `.meta` file.
const PLATFORMS: [&str; 7] =
    ["Android", "Editor", "Linux64", "OSXUniversal", "Win", "Win64", "iOS"];

/// Returns the GUID for a path in the package.
pub fn guid(path: &str) -> String {
    let hash = Sha256::digest(format!("org.htex.htex/{path}"));
    hash.iter().take(16).map(|byte| format!("{byte:02x}")).collect()
}

/// Returns the `.meta` files that a package should have, by path.
pub fn all(package: &Path) -> BTreeMap<String, String> {
    let mut assets = BTreeMap::new();
    walk(package, "", &mut assets);
    for plugin in &PLUGINS {
        assets.insert(plugin.path.to_owned(), false);
    }
    let metas = assets.into_iter().map(|(path, is_folder)| {
        let importer = importer(&path, is_folder);
        let text = format!("fileFormatVersion: 2\nguid: {}\n{importer}", guid(&path));
        (format!("{path}.meta"), text)
    });
    metas.collect()
}

/// Collects everything that Unity imports, and whether it is a folder. Unity ignores folders whose
/// name ends with `~`, but it copies samples together with their `.meta` files to a project.
fn walk(package: &Path, folder: &str, assets: &mut BTreeMap<String, bool>) {
    for entry in fs::read_dir(package.join(folder)).unwrap() {
        let entry = entry.unwrap();
        let name = entry.file_name().into_string().unwrap();
        let path = format!("{folder}{name}");
        let is_folder = entry.file_type().unwrap().is_dir();
        if name != "Documentation~" && is_folder {
            walk(package, &format!("{path}/"), assets);
        }
        if !name.ends_with('~') && !name.ends_with(".meta") {
            assets.insert(path, is_folder);
        }
    }
}

/// Returns the `.meta` files that exist.
pub fn there(package: &Path) -> Vec<String> {
    fn add(package: &Path, folder: &str, metas: &mut Vec<String>) {
        for entry in fs::read_dir(package.join(folder)).unwrap() {
            let entry = entry.unwrap();
            let path = format!("{folder}{}", entry.file_name().into_string().unwrap());
            if entry.file_type().unwrap().is_dir() {
                add(package, &format!("{path}/"), metas);
            } else if path.ends_with(".meta") {
                metas.push(path);
            }
        }
    }
    let mut metas = Vec::new();
    add(package, "", &mut metas);
    metas.sort();
    metas
}

/// Returns how Unity imports a file.
fn importer(path: &str, is_folder: bool) -> String {
    if is_folder {
        return format!("folderAsset: yes\nDefaultImporter:\n  externalObjects: {{}}\n{END}");
    }
    if let Some(plugin) = PLUGINS.iter().find(|plugin| plugin.path == path) {
        return plugin.importer();
    }
    let extension = Path::new(path).extension().unwrap().to_str().unwrap();
    let name = match (extension, path) {
        ("cs", _) => {
            return format!(
                "MonoImporter:\n  externalObjects: {{}}\n  serializedVersion: 2\n  defaultReferences: []\n  executionOrder: 0\n  \
                 icon: {{instanceID: 0}}\n{END}"
            );
        }
        ("htex", _) => {
            let script = guid("Editor/HtexTextureImporter.cs");
            return format!(
                "ScriptedImporter:\n  internalIDToNameTable: []\n  externalObjects: {{}}\n  serializedVersion: 2\n{END}  \
                 script: {{fileID: 11500000, guid: {script}, type: 3}}\n"
            );
        }
        ("asmdef", _) => "AssemblyDefinitionImporter",
        ("md", _) => "TextScriptImporter",
        ("unity", _) => "DefaultImporter",
        (_, "package.json") => "PackageManifestImporter",
        _ => panic!("{path}: say here how Unity imports it"),
    };
    format!("{name}:\n  externalObjects: {{}}\n{END}")
}

impl Plugin {
    fn importer(&self) -> String {
        let (group, platform) = self.platform;
        let excluded: String = PLATFORMS
            .iter()
            .map(|&name| {
                let is_used = name == platform || (name == "Editor" && self.editor.is_some());
                format!("        Exclude {name}: {}\n", u8::from(!is_used))
            })
            .collect();
        let (system, processor) = self.editor.unwrap_or(("", "AnyCPU"));
        let system = match system {
            "" => String::new(),
            system => format!("        OS: {system}\n"),
        };
        let settings: String =
            self.settings.iter().map(|line| format!("        {line}\n")).collect();
        format!(
            "PluginImporter:\n  externalObjects: {{}}\n  serializedVersion: 2\n  iconMap: {{}}\n  executionOrder: {{}}\n  \
             defineConstraints: []\n  isPreloaded: 0\n  isOverridable: 0\n  isExplicitlyReferenced: 0\n  validateReferences: 1\n  \
             platformData:\n  - first:\n      : Any\n    second:\n      enabled: 0\n      settings:\n{excluded}  \
             - first:\n      Any: \n    second:\n      enabled: 0\n      settings: {{}}\n  \
             - first:\n      Editor: Editor\n    second:\n      enabled: {}\n      settings:\n        CPU: {processor}\n        \
             DefaultValueInitialized: true\n{system}  \
             - first:\n      {group}: {platform}\n    second:\n      enabled: 1\n      settings:\n{settings}{END}",
            u8::from(self.editor.is_some()),
        )
    }
}
