//! What holds each function on a device against the host's: for every function that other modules can see a kernel that takes its
//! arguments from a flat buffer and gives its results to another, and the same on the host.

use super::emit::{renamed, type_name};
use super::source::Unit;
use std::collections::BTreeMap;
use std::fmt::Write;
use syn::spanned::Spanned;
use syn::{Expr, FnArg, Item, Pat, ReturnType, Type, Visibility};

/// OpenCL C and Rust.
#[derive(Default)]
pub(crate) struct Parity {
    pub(crate) kernels: String,
    pub(crate) table: String,
}

/// Kernels and table of all functions that can be called from outside of their module.
pub(crate) fn parity(units: &[&Unit]) -> Result<Parity, String> {
    let mut structs = BTreeMap::new();
    for unit in units {
        for item in &unit.items {
            if let Item::Struct(item) = item
                && is_visible(&item.vis)
                && item.fields.iter().all(|field| is_visible(&field.vis))
            {
                structs.insert(item.ident.to_string(), item);
            }
        }
    }
    let mut words = Words { structs, order: Vec::new() };
    let mut kernels = String::new();
    let mut functions = String::new();
    let mut imports = String::new();
    for unit in units {
        let module = unit.name.rsplit('/').next().unwrap_or_default().trim_end_matches(".rs");
        let before = functions.len();
        for item in &unit.items {
            if let Item::Fn(item) = item
                && is_visible(&item.vis)
            {
                let signature = Signature::of(unit, item)?;
                if signature.types().all(|ty| words.uses(ty)) {
                    kernels.push_str(&signature.kernel());
                    functions.push_str(&signature.host(module));
                }
            }
        }
        if functions.len() > before {
            let _ = write!(imports, ", {module}");
        }
    }
    let text = words.text(units)?;
    let structs: Vec<String> = words.order.iter().map(|name| words.rust(name)).collect();
    for (name, module) in words.order.iter().filter_map(|name| Some((name, module_of(units, name)?))) {
        let _ = write!(imports, ", {module}::{name}");
    }
    Ok(Parity {
        kernels: format!("{text}{kernels}"),
        table: format!(
            "\nuse super::{{FLAGS, Function, Word, Words}};\nuse crate::cell::{{TAG_CONE{imports}}};\n\n{}\n\
             /// Every function that other modules can see.\npub static FUNCTIONS: &[Function] = &[\n{functions}];\n",
            structs.concat()
        ),
    })
}

fn is_visible(visibility: &Visibility) -> bool {
    !matches!(visibility, Visibility::Inherited)
}

/// The module that declares a struct.
fn module_of<'a>(units: &[&'a Unit], name: &str) -> Option<&'a str> {
    let unit = units.iter().find(|unit| unit.items.iter().any(|i| matches!(i, Item::Struct(i) if i.ident == name)))?;
    Some(unit.name.rsplit('/').next()?.trim_end_matches(".rs"))
}

/// The structs that become words.
struct Words<'a> {
    structs: BTreeMap<String, &'a syn::ItemStruct>,
    /// Those that some function takes or gives, after what they are made of.
    order: Vec<String>,
}

impl Words<'_> {
    /// Whether a type has words; notes that they are used.
    fn uses(&mut self, ty: &Type) -> bool {
        match ty {
            Type::Array(array) => self.uses(&array.elem),
            Type::Path(path) => {
                let Some(name) = path.path.get_ident().map(ToString::to_string) else { return false };
                if matches!(name.as_str(), "Real" | "u32" | "i32" | "bool") || self.order.contains(&name) {
                    return true;
                }
                let Some(&item) = self.structs.get(&name) else { return false };
                let has_words = item.fields.iter().all(|field| self.uses(&field.ty));
                if has_words {
                    self.order.push(name);
                }
                has_words
            }
            _ => false,
        }
    }

    /// How each struct is taken and given in OpenCL C.
    fn text(&self, units: &[&Unit]) -> Result<String, String> {
        let Some(unit) = units.first() else { return Ok(String::new()) };
        let mut text = String::new();
        for name in &self.order {
            let (mut takes, mut gives) = (String::new(), String::new());
            for field in &self.structs[name].fields {
                let member = field.ident.as_ref().map(ToString::to_string).unwrap_or_default();
                let (ty, index, every) = match &field.ty {
                    Type::Array(array) => {
                        let Expr::Lit(length) = &array.len else { return unit.error(array.span(), "such length") };
                        let syn::Lit::Int(length) = &length.lit else {
                            return unit.error(length.span(), "such length");
                        };
                        (&*array.elem, "[i]", format!("for (uint i = 0; i < {length}u; i++) "))
                    }
                    ty => (ty, "", String::new()),
                };
                let ty = type_name(unit, ty)?;
                let _ = writeln!(takes, "    {every}value.{member}{index} = take_{ty}(in);");
                let _ = writeln!(gives, "    {every}give_{ty}(out, value.{member}{index});");
            }
            let _ = write!(
                text,
                "\nINLINE {name} take_{name}(Input *in) {{\n    {name} value;\n{takes}    return value;\n}}\n\
                 OUTLINE void give_{name}(Output *out, {name} value) {{\n{gives}}}\n"
            );
        }
        Ok(text)
    }

    /// The same in Rust.
    fn rust(&self, name: &str) -> String {
        let fields: Vec<String> =
            self.structs[name].fields.iter().filter_map(|f| f.ident.as_ref()).map(ToString::to_string).collect();
        format!("words!({name} {{ {} }});\n", fields.join(", "))
    }
}

/// What a function takes and gives.
struct Signature<'a> {
    unit: &'a Unit,
    name: String,
    result: Option<&'a Type>,
    parameters: Vec<Parameter<'a>>,
}

struct Parameter<'a> {
    name: String,
    ty: &'a Type,
    /// `&`, `&mut` or nothing.
    reference: &'static str,
    is_store: bool,
}

impl<'a> Signature<'a> {
    fn of(unit: &'a Unit, function: &'a syn::ItemFn) -> Result<Self, String> {
        let mut parameters = Vec::new();
        for input in &function.sig.inputs {
            let FnArg::Typed(input) = input else { return unit.error(input.span(), "method") };
            let Pat::Ident(name) = &*input.pat else { return unit.error(input.pat.span(), "pattern") };
            let (ty, reference) = match &*input.ty {
                Type::Reference(to) => (&*to.elem, if to.mutability.is_some() { "&mut " } else { "&" }),
                ty => (ty, ""),
            };
            let is_store = matches!(ty, Type::Path(path) if path.path.is_ident("S"));
            parameters.push(Parameter { name: name.ident.to_string(), ty, reference, is_store });
        }
        let result = match &function.sig.output {
            ReturnType::Default => None,
            ReturnType::Type(_, ty) => Some(&**ty),
        };
        Ok(Self { unit, name: function.sig.ident.to_string(), result, parameters })
    }

    fn types(&self) -> impl Iterator<Item = &'a Type> {
        self.parameters.iter().filter(|p| !p.is_store).map(|p| p.ty).chain(self.result)
    }

    fn on_store(&self) -> bool {
        self.parameters.iter().any(|p| p.is_store)
    }

    fn kernel(&self) -> String {
        let ty = |ty| type_name(self.unit, ty).unwrap_or_default();
        let mut text = format!("\n__kernel void parity_{}(PARITY_ARGUMENTS) {{\n    PARITY_CALL;\n", self.name);
        if self.on_store() {
            text.push_str("    PARITY_STORE;\n");
        }
        for p in self.parameters.iter().filter(|p| !p.is_store) {
            let constant = if p.reference.is_empty() { "const " } else { "" };
            let _ = writeln!(text, "    {constant}{} {} = take_{}(&in);", ty(p.ty), p.name, ty(p.ty));
        }
        let arguments: Vec<String> = self.parameters.iter().map(Parameter::in_c).collect();
        let call = format!("{}({})", renamed(&self.name), arguments.join(", "));
        let _ = match self.result {
            None => writeln!(text, "    {call};"),
            // A statement of its own: arguments of one call are evaluated in any order.
            Some(result) => {
                let result = ty(result);
                writeln!(text, "    const {result} result = {call};\n    give_{result}(&out, result);")
            }
        };
        for p in self.outs() {
            let _ = writeln!(text, "    give_{}(&out, {});", ty(p.ty), p.name);
        }
        if self.on_store() {
            text.push_str("    parity_dump(&out, s);\n");
        }
        text.push_str("}\n");
        text
    }

    fn host(&self, module: &str) -> String {
        let mut takes = Vec::new();
        for p in self.parameters.iter().filter(|p| !p.is_store) {
            let ty = type_name_in_rust(p.ty);
            let given = match p.name.as_str() {
                // A tag says where a device keeps the plane: not with the sites.
                "tag" => " = TAG_CONE",
                "flags" => " in FLAGS",
                _ => "",
            };
            takes.push(format!("{}: {ty}{given}", p.name));
        }
        let store = if self.on_store() { "s, " } else { "" };
        let arguments: Vec<String> = self.parameters.iter().map(|p| format!("{}{}", p.reference, p.name)).collect();
        let outs: Vec<&str> = self.outs().map(|p| p.name.as_str()).collect();
        let name = &self.name;
        let (takes, arguments, outs) = (takes.join(", "), arguments.join(", "), outs.join(", "));
        format!("    host!({store}({takes}) {module}::{name}({arguments}), [{outs}]),\n")
    }

    /// What the function sets.
    fn outs(&self) -> impl Iterator<Item = &Parameter<'a>> {
        self.parameters.iter().filter(|p| !p.is_store && p.reference == "&mut ")
    }
}

impl Parameter<'_> {
    fn in_c(&self) -> String {
        if self.reference.is_empty() || self.is_store { self.name.clone() } else { format!("&{}", self.name) }
    }
}

fn type_name_in_rust(ty: &Type) -> String {
    match ty {
        Type::Path(path) => path.path.get_ident().map(ToString::to_string).unwrap_or_default().replace("Real", "f64"),
        _ => String::new(),
    }
}
