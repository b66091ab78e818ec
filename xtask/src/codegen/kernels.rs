//! The table of kernels (`backend-ocl/src/interface/table.rs`) in OpenCL C: for each kernel the parameters of its head, and for each group
//! of parameters a struct and what fills it.

use super::emit::{documentation, type_name};
use super::source::Unit;
use std::fmt::Write;
use syn::parse::{Parse, ParseStream};
use syn::spanned::Spanned;
use syn::{Attribute, Expr, Ident, Item, Lit, Token, Type, braced};

/// A kernel, or a group of parameters.
struct Entry {
    attributes: Vec<Attribute>,
    name: Ident,
    /// The kernel's name; none of a group.
    kernel: Option<Ident>,
    parameters: Vec<Parameter>,
}

struct Parameter {
    attributes: Vec<Attribute>,
    kind: Ident,
    name: Ident,
    ty: Type,
}

struct Table(Vec<Entry>);

impl Parse for Table {
    fn parse(input: ParseStream<'_>) -> syn::Result<Self> {
        let mut entries = Vec::new();
        while !input.is_empty() {
            let attributes = input.call(Attribute::parse_outer)?;
            let word: Ident = input.parse()?;
            let name = input.parse()?;
            let kernel = match word.to_string().as_str() {
                "kernel" => Some((input.parse::<Token![=]>()?, input.parse()?).1),
                "group" => None,
                _ => return Err(syn::Error::new(word.span(), "expected `kernel` or `group`")),
            };
            let fields;
            braced!(fields in input);
            let parameters = fields.parse_terminated(Parameter::parse, Token![,])?;
            entries.push(Entry { attributes, name, kernel, parameters: parameters.into_iter().collect() });
        }
        Ok(Self(entries))
    }
}

impl Parse for Parameter {
    fn parse(input: ParseStream<'_>) -> syn::Result<Self> {
        let attributes = input.call(Attribute::parse_outer)?;
        let (kind, name) = (input.parse()?, input.parse()?);
        input.parse::<Token![:]>()?;
        Ok(Self { attributes, kind, name, ty: input.parse()? })
    }
}

/// The C of a unit's table, if it has one.
pub(crate) fn kernels(unit: &Unit) -> Result<String, String> {
    let mut text = String::new();
    for item in &unit.items {
        let Item::Macro(item) = item else { continue };
        if !item.mac.path.is_ident("kernels") {
            continue;
        }
        let Table(entries) = item
            .mac
            .parse_body()
            .map_err(|error| format!("{} line {}: {error}", unit.name, error.span().start().line))?;
        for entry in &entries {
            text.push_str(&entry.in_c(unit, &entries)?);
        }
    }
    Ok(text)
}

impl Entry {
    fn in_c(&self, unit: &Unit, entries: &[Self]) -> Result<String, String> {
        let mut text = "\n".to_owned();
        for line in documentation(&self.attributes) {
            let _ = writeln!(text, "//{line}");
        }
        let declared = self.declared(unit, entries)?;
        let mut name = self.kernel.as_ref().unwrap_or(&self.name).to_string();
        name.make_ascii_uppercase();
        if self.kernel.is_none() {
            text.push_str("typedef struct {\n");
            for (parameter, declared) in self.parameters.iter().zip(&declared) {
                for line in documentation(&parameter.attributes) {
                    let _ = writeln!(text, "    //{line}");
                }
                let _ = writeln!(text, "    {declared};");
            }
            let fields: Vec<String> = self.parameters.iter().map(|p| format!(".{0} = {0}", p.name)).collect();
            let fields = fields.join(", \\\n    ");
            let _ = write!(
                text,
                "}} {};\n#define {name}_OF_ARGUMENTS (({}){{ \\\n    {fields} \\\n}})\n",
                self.name, self.name
            );
        }
        if self.kernel.is_some() {
            let _ = writeln!(text, "#define {name}_ARGUMENTS \\\n    {}", declared.join(", \\\n    "));
        }
        Ok(text)
    }

    /// The parameters in C, those of groups among them.
    fn declared(&self, unit: &Unit, entries: &[Self]) -> Result<Vec<String>, String> {
        let mut declared = Vec::new();
        for Parameter { kind, name, ty, .. } in &self.parameters {
            let pointer = |space: &str| Ok::<_, String>(format!("{space} {} *{name}", element(unit, ty)?));
            declared.push(match kind.to_string().as_str() {
                "input" => pointer("__global const")?,
                "output" => pointer("__global")?,
                "atomic" => pointer("volatile __global")?,
                "value" => format!("{} {name}", type_name(unit, ty)?),
                "group" => {
                    let is_it = |entry: &&Self| matches!(ty, Type::Path(path) if path.path.is_ident(&entry.name));
                    match entries.iter().find(|entry| entry.kernel.is_none() && is_it(entry)) {
                        Some(_) if self.kernel.is_none() => return unit.error(ty.span(), "group in a group"),
                        Some(group) => declared.extend(group.declared(unit, entries)?),
                        None => return unit.error(ty.span(), "such group"),
                    }
                    continue;
                }
                _ => return unit.error(kind.span(), "such parameter"),
            });
        }
        Ok(declared)
    }
}

/// What a buffer is made of: vectors of two and four numbers; three are three single ones, since vectors of three have the size of four, and six are six.
fn element(unit: &Unit, ty: &Type) -> Result<String, String> {
    let Type::Array(array) = ty else { return type_name(unit, ty) };
    let number = type_name(unit, &array.elem)?;
    match &array.len {
        Expr::Lit(syn::ExprLit { lit: Lit::Int(length), .. }) => match length.base10_digits() {
            "3" | "6" => Ok(number),
            digits @ ("2" | "4") => Ok(format!("{number}{digits}")),
            _ => unit.error(array.span(), "such vector"),
        },
        _ => unit.error(array.span(), "such vector"),
    }
}
