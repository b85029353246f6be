//! The command as a user runs it, on files. One program, in which tests that wait leave room to
//! others.
#![allow(unreachable_pub, clippy::unwrap_used, clippy::panic)] // A failed unwrap is a failed test.

#[path = "../common/browser.rs"]
mod browser;
#[path = "../common/mod.rs"]
mod common;
#[path = "../../../sdk/core/host/tests/it/common/mod.rs"]
mod model;

mod bake;
#[cfg(all(feature = "build", feature = "cloud"))]
mod build_elsewhere;
mod by_hand;
mod catalogue;
#[cfg(unix)]
mod checker;
mod compat;
mod conformance;
mod embed;
mod every_feature;
mod exchange;
mod fit;
mod flags;
mod fluctuation;
mod gain;
mod grid;
mod installing;
mod lab;
mod library;
mod library_builds;
#[cfg(feature = "build")]
mod library_changes;
mod library_described;
#[cfg(target_os = "linux")]
mod memory;
mod metadata;
#[cfg(target_os = "linux")]
mod modules;
#[cfg(unix)]
mod new_project;
mod outputs;
mod pages;
mod play;
#[cfg(unix)]
mod plugins;
mod printed;
#[cfg(feature = "lab")]
mod python_settings;
mod quantities;
#[cfg(all(target_os = "linux", feature = "build"))]
mod random_recipes;
mod readme;
mod recording_findings;
mod recordings;
#[cfg(feature = "lab")]
mod response;
mod rigs;
mod scene;
mod shell;
#[cfg(all(feature = "build", feature = "cloud"))]
mod signed_textures;
#[cfg(feature = "cloud")]
mod storage;
#[cfg(all(unix, feature = "build"))]
mod strangers;
#[cfg(feature = "lab")]
mod studio;
mod tradeoff;
mod triangles;
mod validate;
mod versions;
