//! What the host and the kernels share, from its Rust text to OpenCL C: constants, structs without padding, which every compiler
//! therefore lays out alike, and the parameters of kernels.

use super::emit;
use super::kernels::kernels;
use super::source::Unit;
use std::collections::HashMap;
use std::fmt::Write;
use syn::spanned::Spanned;
use syn::{Expr, Item, Lit, Type};

/// The C of a module of the interface and of items borrowed from other modules, which come first; `real` is what a `Real` is in C.
pub(crate) fn interface(borrowed: Vec<Unit>, module: Vec<Unit>, real: &'static str) -> Result<String, String> {
    let mut text = String::new();
    let mut layouts = Layouts { real: if real == "float" { 4 } else { 8 }, ..Layouts::default() };
    for mut unit in borrowed.into_iter().chain(module) {
        unit.real = real;
        let _ = write!(text, "\n// {}\n{}{}", unit.name, emit::unit(&unit)?.types, kernels(&unit)?);
        for item in &unit.items {
            layouts.note(&unit, item)?;
        }
    }
    let asserts = layouts
        .structs
        .iter()
        .map(|(name, bytes)| format!("typedef char size_of_{name}[(sizeof({name}) == {bytes}) ? 1 : -1];\n"));
    let asserts: String = asserts.collect();
    if !asserts.is_empty() {
        let _ = write!(text, "\n// Sizes as on the host: a compiler that pads does not build this.\n{asserts}");
    }
    Ok(text)
}

/// A unit with only the items of these names.
pub(crate) fn only(mut unit: Unit, names: &[&str]) -> Result<Unit, String> {
    let has = |item: &Item, name: &str| super::source::name_of(item).is_some_and(|found| found == name);
    if let Some(missing) = names.iter().find(|name| !unit.items.iter().any(|item| has(item, name))) {
        return Err(format!("{} has no `{missing}`", unit.name));
    }
    unit.items.retain(|item| names.iter().any(|name| has(item, name)));
    Ok(unit)
}

/// Sizes of structs, and the constants that are lengths of arrays.
#[derive(Default)]
struct Layouts {
    real: usize,
    structs: Vec<(String, usize)>,
    aligned: HashMap<String, usize>,
    lengths: HashMap<String, usize>,
}

impl Layouts {
    fn note(&mut self, unit: &Unit, item: &Item) -> Result<(), String> {
        match item {
            Item::Const(constant) => {
                if let Some(value) = number(&constant.expr) {
                    self.lengths.insert(constant.ident.to_string(), value);
                }
            }
            Item::Struct(item) => {
                if !item.attrs.iter().any(|a| a.path().is_ident("repr")) {
                    return unit.error(item.ident.span(), "shared struct without #[repr(C)]");
                }
                let (mut bytes, mut aligned) = (0, 1);
                for field in &item.fields {
                    let (own, own_aligned) = self.of(unit, &field.ty)?;
                    if bytes % own_aligned != 0 {
                        return unit.error(field.span(), "padding before a field of a shared struct");
                    }
                    bytes += own;
                    aligned = aligned.max(own_aligned);
                }
                if bytes % aligned != 0 {
                    return unit.error(item.ident.span(), "padding at the end of a shared struct");
                }
                self.structs.push((item.ident.to_string(), bytes));
                self.aligned.insert(item.ident.to_string(), aligned);
            }
            _ => {}
        }
        Ok(())
    }

    /// Bytes of a type, and what its address is a multiple of.
    fn of(&self, unit: &Unit, ty: &Type) -> Result<(usize, usize), String> {
        match ty {
            Type::Array(array) => {
                let length = match &array.len {
                    Expr::Path(path) => path.path.get_ident().and_then(|n| self.lengths.get(&n.to_string()).copied()),
                    length => number(length),
                };
                let Some(length) = length else { return unit.error(array.span(), "such length") };
                let (bytes, aligned) = self.of(unit, &array.elem)?;
                Ok((bytes * length, aligned))
            }
            Type::Path(path) => {
                let name = path.path.get_ident().map(ToString::to_string).unwrap_or_default();
                match name.as_str() {
                    "f64" | "u64" => Ok((8, 8)),
                    "f32" | "u32" | "i32" => Ok((4, 4)),
                    "Real" => Ok((self.real, self.real)),
                    // Of the dialect, three numbers.
                    "V3" => Ok((3 * self.real, self.real)),
                    _ => match self.structs.iter().find(|(found, _)| *found == name) {
                        Some((_, bytes)) => Ok((*bytes, self.aligned[&name])),
                        None => unit.error(path.span(), "such type in a shared struct"),
                    },
                }
            }
            _ => unit.error(ty.span(), "such type in a shared struct"),
        }
    }
}

fn number(expr: &Expr) -> Option<usize> {
    let Expr::Lit(syn::ExprLit { lit: Lit::Int(int), .. }) = expr else { return None };
    int.base10_parse().ok()
}
