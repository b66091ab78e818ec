//! What dependencies may be: their licences, versions and sources, held to `deny.toml`, whose words are cargo-deny's.

use std::collections::BTreeMap;
use std::fs;
use std::str::FromStr;

use serde_json::Value;
use spdx::{Expression, Licensee, ParseMode};

use crate::run::{command, root, succeed};

/// The workspaces whose dependencies reach users. (That of `fuzz` reaches none.)
const WORKSPACES: [&str; 2] = ["Cargo.toml", "python/Cargo.toml"];

/// Where crates may come from, as `cargo metadata` names it.
const REGISTRY: &str = "registry+https://github.com/rust-lang/crates.io-index";

pub(crate) fn run() -> Result<(), String> {
    let text = fs::read_to_string(root().join("deny.toml")).map_err(|error| format!("deny.toml: {error}"))?;
    let rules = Rules::of(&text)?;
    for workspace in WORKSPACES {
        let line = ["metadata", "--locked", "--format-version", "1", "--all-features", "--manifest-path", workspace];
        let found = succeed(&mut command(&line, &[]))?;
        let found: Value = serde_json::from_str(&found).map_err(|error| format!("cargo metadata: {error}"))?;
        let packages = found["packages"].as_array().ok_or("cargo metadata names no packages")?;
        let wrong = rules.broken_by(packages);
        if !wrong.is_empty() {
            return Err(format!("{workspace} against deny.toml: {}", wrong.join("; ")));
        }
        println!("{workspace}: {} crates are as deny.toml wants them", packages.len());
    }
    Ok(())
}

/// What of `deny.toml` is held to. Of its other words there is one value that makes sense here: other sources are denied, and so are
/// dependencies of any version but those by path.
struct Rules {
    licenses: Vec<Licensee>,
    /// Crates, each with the beginning of its version, of which there is a newer one, too.
    skipped: Vec<String>,
}

impl Rules {
    fn of(text: &str) -> Result<Self, String> {
        let file = toml::Table::from_str(text).map_err(|error| format!("deny.toml: {error}"))?;
        let list = |section: &str, name: &str| {
            let found = file.get(section).and_then(|section| section.get(name)).and_then(toml::Value::as_array);
            found.cloned().ok_or_else(|| format!("deny.toml: [{section}] has no list '{name}'"))
        };
        let licensee = |name: toml::Value| {
            let name = name.as_str().unwrap_or_default();
            Licensee::parse(name).map_err(|error| format!("deny.toml: licence '{name}': {}", error.reason))
        };
        let skipped = |entry: toml::Value| {
            let name = entry.get("crate").and_then(toml::Value::as_str);
            name.map(str::to_owned).ok_or("deny.toml: an entry of 'skip' names no crate".to_owned())
        };
        Ok(Self {
            licenses: list("licenses", "allow")?.into_iter().map(licensee).collect::<Result<_, _>>()?,
            skipped: list("bans", "skip")?.into_iter().map(skipped).collect::<Result<_, _>>()?,
        })
    }

    /// What is wrong with packages of `cargo metadata`, an entry each.
    fn broken_by(&self, packages: &[Value]) -> Vec<String> {
        let mut wrong = Vec::new();
        let mut versions = BTreeMap::<&str, Vec<&str>>::new();
        for package in packages {
            let [name, version] = ["name", "version"].map(|key| package[key].as_str().unwrap_or_default());
            if let Some(license) = self.refused(package["license"].as_str()) {
                wrong.push(format!("{name} {version} is under {license}"));
            }
            match package["source"].as_str() {
                Some(REGISTRY) => {}
                Some(other) => wrong.push(format!("{name} {version} is from {other}")),
                None => wrong.extend(any_version(package).map(|other| format!("{name} takes any version of {other}"))),
            }
            if !self.skips(name, version) {
                versions.entry(name).or_default().push(version);
            }
        }
        let twice = versions.into_iter().filter(|(_, versions)| versions.len() > 1);
        wrong.extend(twice.map(|(name, versions)| format!("{name} comes in versions {}", versions.join(" and "))));
        wrong
    }

    /// A licence that is not allowed, or none.
    fn refused<'a>(&self, license: Option<&'a str>) -> Option<&'a str> {
        let Some(license) = license else { return Some("no licence that it names") };
        let allows = |expression: Expression| {
            expression.evaluate(|asked| self.licenses.iter().any(|licensee| licensee.satisfies(asked)))
        };
        let allowed = Expression::parse_mode(license, ParseMode::LAX).is_ok_and(allows);
        (!allowed).then_some(license)
    }

    /// Whether this is a version beside which there may be another.
    fn skips(&self, name: &str, version: &str) -> bool {
        self.skipped.iter().any(|skipped| {
            let rest = skipped.split_once('@').filter(|(of, _)| *of == name);
            rest.and_then(|(_, start)| version.strip_prefix(start)).is_some_and(|rest| rest.starts_with('.'))
        })
    }
}

/// What a package of this project depends on, whatever its version, and not by a path.
fn any_version(package: &Value) -> impl Iterator<Item = &str> {
    let all = package["dependencies"].as_array().into_iter().flatten();
    all.filter(|other| other["req"] == "*" && other["path"].is_null()).filter_map(|other| other["name"].as_str())
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn wrong_with(changes: &Value) -> Vec<String> {
        let rules = "[licenses]\nallow = [\"MIT\", \"Apache-2.0 WITH LLVM-exception\"]\n[bans]\nskip = [{ crate = \"syn@2\" }]\n";
        let mut package =
            json!({"name": "syn", "version": "3.0.1", "license": "MIT OR Apache-2.0", "source": REGISTRY});
        let older = json!({"name": "syn", "version": "2.0.1", "license": "Apache-2.0/MIT", "source": REGISTRY});
        package.as_object_mut().unwrap().extend(changes.as_object().unwrap().clone());
        Rules::of(rules).unwrap().broken_by(&[package, older])
    }

    #[test]
    fn what_the_rules_do_not_allow_is_named() {
        assert!(wrong_with(&json!({})).is_empty());
        assert!(wrong_with(&json!({"license": "(MIT OR GPL-3.0) AND Apache-2.0 WITH LLVM-exception"})).is_empty());
        for license in ["GPL-3.0", "MIT AND Unicode-3.0", "Apache-2.0", "as you like"] {
            assert_eq!(wrong_with(&json!({"license": license})), [format!("syn 3.0.1 is under {license}")]);
        }
        assert_eq!(wrong_with(&json!({"license": null})), ["syn 3.0.1 is under no licence that it names"]);
        assert_eq!(wrong_with(&json!({"source": "git+https://a.b/c"})), ["syn 3.0.1 is from git+https://a.b/c"]);
        assert!(wrong_with(&json!({"version": "20.1.0"})).is_empty());
        let dependencies = json!([{"name": "core", "req": "*", "path": "/here"}, {"name": "rand", "req": "*"}]);
        let own = json!({"source": null, "dependencies": dependencies});
        assert_eq!(wrong_with(&own), ["syn takes any version of rand"]);
    }

    #[test]
    fn a_second_version_is_named_but_for_those_that_are_skipped() {
        let rules = Rules::of("[licenses]\nallow = [\"MIT\"]\n[bans]\nskip = [{ crate = \"a@0.1\" }]\n").unwrap();
        let package = |name, version| json!({"name": name, "version": version, "license": "MIT", "source": REGISTRY});
        let found = ["0.1.2", "0.1.3", "0.10.0", "0.2.0"].map(|version| package("a", version));
        assert_eq!(rules.broken_by(&found), ["a comes in versions 0.10.0 and 0.2.0"]);
        assert!(rules.broken_by(&[package("a", "0.1.2"), package("a", "1.0.0"), package("b", "1.0.0")]).is_empty());
    }
}
