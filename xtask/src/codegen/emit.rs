//! The mapping itself: items, statements, expressions.

use super::source::{Unit, is_of_numbers};
use std::collections::HashMap;
use std::fmt::Write;
use syn::punctuated::Punctuated;
use syn::spanned::Spanned;
use syn::{BinOp, Expr, FnArg, Item, Lit, Meta, Pat, RangeLimits, ReturnType, Stmt, Token, Type, UnOp};

/// The C of one file.
#[derive(Default)]
pub(crate) struct Parts {
    pub(crate) types: String,
    pub(crate) prototypes: String,
    pub(crate) functions: String,
}

/// Names that are taken in OpenCL C.
const RENAMED: [(&str, &str); 2] = [("dot", "v3_dot"), ("cross", "v3_cross")];

/// What a name stands for.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Value,
    /// `&mut` of a local of the caller.
    Pointer,
    /// The store.
    Store,
}

/// Translates the items of a file. Traits, implementations, modules and imports are the host's own and left out, and so is every
/// function that implements nothing of the dialect (`#[cfg(…)]`).
pub(crate) fn unit(unit: &Unit) -> Result<Parts, String> {
    let mut parts = Parts::default();
    for item in &unit.items {
        match item {
            Item::Const(constant) => {
                let mut emitter = Emitter::new(unit);
                let value = emitter.expression(&constant.expr)?;
                parts.types.push('\n');
                comments(&mut parts.types, &constant.attrs);
                let ty = emitter.type_name(&constant.ty)?;
                let define = |value: &str| format!("#define {} (({ty}){})\n", constant.ident, grouped(value));
                match argument(unit, "single", &said(unit, &constant.attrs, &["single"])?)? {
                    None => parts.types.push_str(&define(&value)),
                    Some(single) => {
                        let single = define(&format!("REAL({single})"));
                        let _ = write!(parts.types, "#if SINGLE\n{single}#else\n{}#endif\n", define(&value));
                    }
                }
            }
            Item::Struct(item) if is_of_numbers(&item.generics) && is_plain(&item.attrs) => {
                parts.types.push('\n');
                comments(&mut parts.types, &item.attrs);
                let emitter = Emitter::new(unit);
                parts.types.push_str("typedef struct {\n");
                for field in &item.fields {
                    let Some(name) = &field.ident else { return unit.error(field.span(), "unnamed field") };
                    let declared = emitter.declare(&name.to_string(), &field.ty)?;
                    for line in documentation(&field.attrs) {
                        let _ = writeln!(parts.types, "    //{line}");
                    }
                    let _ = writeln!(parts.types, "    {declared};");
                }
                let _ = writeln!(parts.types, "}} {};", item.ident);
            }
            Item::Fn(function) => {
                let mut emitter = Emitter::new(unit);
                let head = emitter.head(function)?;
                let _ = writeln!(parts.prototypes, "{head};");
                parts.functions.push('\n');
                comments(&mut parts.functions, &function.attrs);
                let _ = writeln!(parts.functions, "{head} {{");
                match argument(unit, "returns", &said(unit, &function.attrs, FUNCTION)?)? {
                    Some(value) => {
                        let _ = writeln!(parts.functions, "    return {value};");
                    }
                    None => {
                        emitter.body(function)?;
                        parts.functions.push_str(&emitter.out);
                    }
                }
                parts.functions.push_str("}\n");
            }
            _ => {}
        }
    }
    Ok(parts)
}

/// `#[cfg(not(opencl))]`: a statement of hosts alone.
fn is_of_hosts(attr: &syn::Attribute) -> bool {
    let says = |meta: Meta| matches!(&meta, Meta::List(list) if list.path.is_ident("not") && list.tokens.to_string() == "opencl");
    attr.path().is_ident("cfg") && attr.parse_args::<Meta>().is_ok_and(says)
}

/// Whether a struct is data of the dialect: laid out as in C, or private scratch that may be copied.
fn is_plain(attrs: &[syn::Attribute]) -> bool {
    attrs.iter().any(|a| a.path().is_ident("repr")) || attrs.iter().all(|a| !a.path().is_ident("cfg"))
}

pub(super) fn documentation(attrs: &[syn::Attribute]) -> Vec<String> {
    let text = |attr: &syn::Attribute| match &attr.meta {
        syn::Meta::NameValue(pair) if pair.path.is_ident("doc") => match &pair.value {
            Expr::Lit(syn::ExprLit { lit: syn::Lit::Str(text), .. }) => Some(text.value()),
            _ => None,
        },
        _ => None,
    };
    attrs.iter().filter_map(text).collect()
}

/// What can be said of a function.
const FUNCTION: &[&str] = &["outline", "hot", "returns"];

/// What `#[cfg_attr(opencl, …)]` says to the translator; the place allows the given names.
fn said(unit: &Unit, attrs: &[syn::Attribute], allowed: &[&str]) -> Result<Vec<Meta>, String> {
    let mut all = Vec::new();
    for attr in attrs.iter().filter(|attr| attr.path().is_ident("cfg_attr")) {
        let parts = attr.parse_args_with(Punctuated::<Meta, Token![,]>::parse_terminated);
        let mut parts = parts.or_else(|_| unit.error(attr.span(), "such attribute"))?.into_iter();
        if !parts.next().is_some_and(|condition| condition.path().is_ident("opencl")) {
            continue;
        }
        for part in parts {
            if !allowed.iter().any(|name| part.path().is_ident(name)) {
                return unit.error(part.span(), "such attribute");
            }
            all.push(part);
        }
    }
    Ok(all)
}

/// The argument of `name(…)`: a constant's value in single precision (`single`), or what devices return instead, because it is faster there
/// (`returns`, as a string).
fn argument(unit: &Unit, name: &str, said: &[Meta]) -> Result<Option<String>, String> {
    let Some(part) = said.iter().find(|part| part.path().is_ident(name)) else { return Ok(None) };
    let Meta::List(list) = part else { return unit.error(part.span(), "such attribute") };
    match syn::parse2(list.tokens.clone()) {
        Ok(Lit::Str(text)) => Ok(Some(text.value())),
        Ok(Lit::Float(number)) => Ok(Some(number.to_string())),
        _ => unit.error(list.span(), "such value"),
    }
}

/// How a function is called: from several places as one piece of code (`outline`), inlined where lanes share a cell (`hot`), or always inlined.
fn storage(unit: &Unit, function: &syn::ItemFn) -> Result<&'static str, String> {
    let said = said(unit, &function.attrs, FUNCTION)?;
    let has = |name| said.iter().any(|part| part.path().is_ident(name));
    match (has("outline"), has("hot")) {
        (false, false) => Ok("INLINE"),
        (false, true) => Ok("HOT"),
        (true, false) => Ok("OUTLINE"),
        (true, true) => unit.error(function.sig.span(), "function that is both `outline` and `hot`"),
    }
}

fn comments(out: &mut String, attrs: &[syn::Attribute]) {
    for line in documentation(attrs) {
        let _ = writeln!(out, "//{line}");
    }
}

/// An expression in parentheses, unless it stands in its own.
fn grouped(text: &str) -> String {
    if text.starts_with('(') && closes_at_end(text) { text.to_owned() } else { format!("({text})") }
}

fn closes_at_end(text: &str) -> bool {
    let mut depth = 0;
    for (i, c) in text.char_indices() {
        match c {
            '(' => depth += 1,
            ')' => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return i + 1 == text.len();
        }
    }
    false
}

struct Emitter<'a> {
    unit: &'a Unit,
    out: String,
    names: HashMap<String, Kind>,
    indent: usize,
    /// The last line of source whose comments are out.
    line: usize,
}

impl<'a> Emitter<'a> {
    fn new(unit: &'a Unit) -> Self {
        Self { unit, out: String::new(), names: HashMap::new(), indent: 1, line: 0 }
    }

    /// Return type, name and parameters.
    fn head(&mut self, function: &syn::ItemFn) -> Result<String, String> {
        let signature = &function.sig;
        let storage = storage(self.unit, function)?;
        let result = match &signature.output {
            ReturnType::Default => "void".to_owned(),
            ReturnType::Type(_, ty) => self.type_name(ty)?,
        };
        let mut parameters = Vec::new();
        for input in &signature.inputs {
            let FnArg::Typed(input) = input else { return self.unit.error(input.span(), "method") };
            let Pat::Ident(name) = &*input.pat else { return self.unit.error(input.pat.span(), "pattern") };
            let name = name.ident.to_string();
            let (kind, declared) = match &*input.ty {
                Type::Reference(reference) => match &*reference.elem {
                    Type::Path(path) if path.path.is_ident("S") => (Kind::Store, format!("Store *{name}")),
                    elem => (Kind::Pointer, format!("{} *{name}", self.type_name(elem)?)),
                },
                ty => (Kind::Value, self.declare(&name, ty)?),
            };
            self.names.insert(name, kind);
            parameters.push(declared);
        }
        Ok(format!("{storage} {result} {}({})", renamed(&signature.ident.to_string()), parameters.join(", ")))
    }

    fn body(&mut self, function: &syn::ItemFn) -> Result<(), String> {
        self.line = function.sig.span().end().line;
        self.block(&function.block)
    }

    fn block(&mut self, block: &syn::Block) -> Result<(), String> {
        for statement in &block.stmts {
            self.statement(statement)?;
        }
        let end = block.span().end().line;
        self.flush_comments(end);
        Ok(())
    }

    fn flush_comments(&mut self, before: usize) {
        let lines: Vec<String> = self.unit.comments_between(self.line, before).map(str::to_owned).collect();
        for line in lines {
            self.put(&format!("// {line}"));
        }
        self.line = self.line.max(before);
    }

    fn put(&mut self, text: &str) {
        let _ = writeln!(self.out, "{:width$}{text}", "", width = 4 * self.indent);
    }

    fn statement(&mut self, statement: &Stmt) -> Result<(), String> {
        self.flush_comments(statement.span().start().line);
        match statement {
            Stmt::Local(local) => {
                let Pat::Type(typed) = &local.pat else { return self.unit.error(local.span(), "local without type") };
                let Pat::Ident(name) = &*typed.pat else { return self.unit.error(typed.pat.span(), "pattern") };
                let name_text = name.ident.to_string();
                let declared = self.declare(&name_text, &typed.ty)?;
                let line = match &local.init {
                    None => format!("{declared};"),
                    Some(init) => {
                        let constant = if name.mutability.is_some() { "" } else { "const " };
                        format!("{constant}{declared} = {};", self.expression(&init.expr)?)
                    }
                };
                self.put(&line);
                self.names.insert(name_text, Kind::Value);
                Ok(())
            }
            Stmt::Expr(Expr::If(branch), _) if branch.attrs.iter().any(is_of_hosts) => Ok(()),
            Stmt::Expr(expr, _) => self.statement_expression(expr),
            other => self.unit.error(other.span(), "item or macro in a body"),
        }
    }

    fn statement_expression(&mut self, expr: &Expr) -> Result<(), String> {
        match expr {
            Expr::If(branch) => {
                let condition = self.expression(&branch.cond)?;
                self.put(&format!("if {} {{", grouped(&condition)));
                self.inner(&branch.then_branch)?;
                let mut rest = branch.else_branch.as_ref().map(|(_, rest)| &**rest);
                while let Some(present) = rest {
                    match present {
                        Expr::If(next) => {
                            let condition = self.expression(&next.cond)?;
                            self.put(&format!("}} else if {} {{", grouped(&condition)));
                            self.inner(&next.then_branch)?;
                            rest = next.else_branch.as_ref().map(|(_, rest)| &**rest);
                        }
                        Expr::Block(block) => {
                            self.put("} else {");
                            self.inner(&block.block)?;
                            rest = None;
                        }
                        other => return self.unit.error(other.span(), "such branch"),
                    }
                }
                self.put("}");
            }
            Expr::While(looped) => {
                self.rolled(&looped.attrs)?;
                let condition = self.expression(&looped.cond)?;
                self.put(&format!("while {} {{", grouped(&condition)));
                self.inner(&looped.body)?;
                self.put("}");
            }
            Expr::ForLoop(looped) => {
                self.rolled(&looped.attrs)?;
                let Pat::Ident(name) = &*looped.pat else { return self.unit.error(looped.pat.span(), "pattern") };
                let Expr::Range(syn::ExprRange {
                    start: Some(start),
                    limits: RangeLimits::HalfOpen(_),
                    end: Some(end),
                    ..
                }) = &*looped.expr
                else {
                    return self.unit.error(looped.expr.span(), "loop but over `a..b`");
                };
                let name = name.ident.to_string();
                let (start, end) = (self.expression(start)?, self.operand(end)?);
                self.put(&format!("for (uint {name} = {start}; {name} < {end}; {name}++) {{"));
                self.inner(&looped.body)?;
                self.put("}");
            }
            Expr::Loop(looped) => {
                self.put("for (;;) {");
                self.inner(&looped.body)?;
                self.put("}");
            }
            Expr::Return(returned) => {
                let value = match &returned.expr {
                    Some(value) => format!(" {}", self.expression(value)?),
                    None => String::new(),
                };
                self.put(&format!("return{value};"));
            }
            Expr::Break(_) => self.put("break;"),
            Expr::Continue(_) => self.put("continue;"),
            other => {
                let text = self.expression(other)?;
                self.put(&format!("{text};"));
            }
        }
        Ok(())
    }

    /// Before a loop, that it is to be unrolled or is not, where its attributes say so.
    fn rolled(&mut self, attrs: &[syn::Attribute]) -> Result<(), String> {
        if let Some(attr) = attrs.iter().find(|attr| !attr.path().is_ident("cfg_attr")) {
            return self.unit.error(attr.span(), "such attribute");
        }
        for part in said(self.unit, attrs, &["rolled", "unrolled"])? {
            self.put(if part.path().is_ident("rolled") { "ROLLED" } else { "UNROLLED" });
        }
        Ok(())
    }

    fn inner(&mut self, block: &syn::Block) -> Result<(), String> {
        self.indent += 1;
        let known = self.names.clone();
        self.block(block)?;
        self.names = known;
        self.indent -= 1;
        Ok(())
    }

    fn expression(&mut self, expr: &Expr) -> Result<String, String> {
        Ok(match expr {
            Expr::Lit(literal) => match &literal.lit {
                syn::Lit::Int(int) => int.to_string().replace('_', ""),
                syn::Lit::Bool(truth) => u32::from(truth.value).to_string(),
                syn::Lit::Float(float) => {
                    let float = float.to_string().replace('_', "");
                    if self.unit.real == "double" { float } else { format!("REAL({float})") }
                }
                other => return self.unit.error(other.span(), "such literal"),
            },
            Expr::Path(path) => match path.path.get_ident() {
                Some(name) => name.to_string(),
                None => return self.unit.error(path.span(), "qualified name"),
            },
            Expr::Paren(inner) => format!("({})", self.expression(&inner.expr)?),
            Expr::Unary(unary) => {
                let operand = self.expression(&unary.expr)?;
                match unary.op {
                    UnOp::Neg(_) => format!("-{operand}"),
                    UnOp::Not(_) => format!("!{operand}"),
                    UnOp::Deref(_) => format!("*{operand}"),
                    _ => return self.unit.error(unary.span(), "such operator"),
                }
            }
            Expr::Binary(binary) => {
                // C ranks `&` below `==`: operands that are operations go into parentheses.
                let (left, right) = (self.operand(&binary.left)?, self.operand(&binary.right)?);
                format!("{left} {} {right}", self.operator(&binary.op)?)
            }
            Expr::Assign(assign) => {
                format!("{} = {}", self.expression(&assign.left)?, self.expression(&assign.right)?)
            }
            Expr::Field(field) => {
                let base = self.expression(&field.base)?;
                let syn::Member::Named(member) = &field.member else {
                    return self.unit.error(field.span(), "tuple field");
                };
                let arrow = if self.kind_of(&field.base) == Kind::Pointer { "->" } else { "." };
                format!("{base}{arrow}{member}")
            }
            Expr::Index(index) => {
                format!("{}[{}]", self.expression(&index.expr)?, self.expression(without_cast(&index.index))?)
            }
            Expr::Reference(reference) => format!("&{}", self.expression(&reference.expr)?),
            Expr::Cast(cast) => format!("({}){}", self.type_name(&cast.ty)?, self.expression(&cast.expr)?),
            Expr::Call(call) => self.call(call)?,
            Expr::MethodCall(call) => self.method(call)?,
            Expr::Struct(literal) => self.literal(literal)?,
            Expr::Repeat(_) => "{ 0 }".to_owned(),
            other => return self.unit.error(other.span(), "such expression"),
        })
    }

    fn operand(&mut self, expr: &Expr) -> Result<String, String> {
        let text = self.expression(expr)?;
        Ok(if matches!(expr, Expr::Binary(_)) { format!("({text})") } else { text })
    }

    fn call(&mut self, call: &syn::ExprCall) -> Result<String, String> {
        let Expr::Path(path) = &*call.func else { return self.unit.error(call.span(), "call of a value") };
        let names: Vec<String> = path.path.segments.iter().map(|s| s.ident.to_string()).collect();
        match names.iter().map(String::as_str).collect::<Vec<_>>()[..] {
            [name] => {
                let arguments = self.arguments(&call.args)?;
                Ok(format!("{}({})", renamed(name), arguments.join(", ")))
            }
            [ty, "default"] => Ok(format!("({ty}){{ 0 }}")),
            _ => self.unit.error(call.span(), "qualified call"),
        }
    }

    fn method(&mut self, call: &syn::ExprMethodCall) -> Result<String, String> {
        let receiver = self.expression(&call.receiver)?;
        let mut arguments = self.arguments(&call.args)?;
        let name = call.method.to_string();
        if self.kind_of(&call.receiver) == Kind::Store {
            arguments.insert(0, receiver);
            return Ok(format!("store_{name}({})", arguments.join(", ")));
        }
        match name.as_str() {
            "abs" => Ok(format!("fabs{}", grouped(&receiver))),
            "sqrt" => Ok(format!("sqrt{}", grouped(&receiver))),
            "max" => Ok(format!("fmax({receiver}, {})", arguments.join(""))),
            "wrapping_sub" => Ok(format!("({receiver} - {})", arguments.join(""))),
            _ => self.unit.error(call.method.span(), "such method"),
        }
    }

    fn arguments<'b>(&mut self, arguments: impl IntoIterator<Item = &'b Expr>) -> Result<Vec<String>, String> {
        arguments.into_iter().map(|argument| self.expression(argument)).collect()
    }

    fn literal(&mut self, literal: &syn::ExprStruct) -> Result<String, String> {
        let Some(name) = literal.path.get_ident() else { return self.unit.error(literal.span(), "qualified name") };
        let mut fields = Vec::new();
        for field in &literal.fields {
            let syn::Member::Named(member) = &field.member else {
                return self.unit.error(field.span(), "tuple field");
            };
            fields.push(format!(".{member} = {}", self.expression(&field.expr)?));
        }
        Ok(format!("({name}){{ {} }}", fields.join(", ")))
    }

    fn kind_of(&self, expr: &Expr) -> Kind {
        match expr {
            Expr::Path(path) => {
                let name = path.path.get_ident().map(ToString::to_string).unwrap_or_default();
                self.names.get(&name).copied().unwrap_or(Kind::Value)
            }
            Expr::Paren(inner) => self.kind_of(&inner.expr),
            _ => Kind::Value,
        }
    }

    fn operator(&self, op: &BinOp) -> Result<&'static str, String> {
        Ok(match op {
            BinOp::Add(_) => "+",
            BinOp::Sub(_) => "-",
            BinOp::Mul(_) => "*",
            BinOp::Div(_) => "/",
            BinOp::And(_) => "&&",
            BinOp::Or(_) => "||",
            BinOp::BitXor(_) => "^",
            BinOp::BitAnd(_) => "&",
            BinOp::BitOr(_) => "|",
            BinOp::Shl(_) => "<<",
            BinOp::Shr(_) => ">>",
            BinOp::Eq(_) => "==",
            BinOp::Ne(_) => "!=",
            BinOp::Lt(_) => "<",
            BinOp::Le(_) => "<=",
            BinOp::Gt(_) => ">",
            BinOp::Ge(_) => ">=",
            BinOp::AddAssign(_) => "+=",
            BinOp::SubAssign(_) => "-=",
            _ => return self.unit.error(op.span(), "such operator"),
        })
    }

    fn type_name(&self, ty: &Type) -> Result<String, String> {
        type_name(self.unit, ty)
    }

    /// A declaration of `name`.
    fn declare(&self, name: &str, ty: &Type) -> Result<String, String> {
        match ty {
            Type::Array(array) => {
                let length = match &array.len {
                    Expr::Lit(syn::ExprLit { lit: syn::Lit::Int(length), .. }) => length.to_string(),
                    Expr::Path(path) if path.path.get_ident().is_some() => path.path.segments[0].ident.to_string(),
                    length => return self.unit.error(length.span(), "such length of an array"),
                };
                self.declare(&format!("{name}[{length}]"), &array.elem)
            }
            // (In memory that the host shares a vector is three of the host's numbers, whatever the kernels' own are.)
            Type::Path(path) if path.path.is_ident("V3") && self.unit.real != "real" => {
                Ok(format!("{} {name}[3]", self.unit.real))
            }
            ty => Ok(format!("{} {name}", self.type_name(ty)?)),
        }
    }
}

/// An index is `u32` in the dialect and cast for Rust alone.
fn without_cast(expr: &Expr) -> &Expr {
    if let Expr::Cast(cast) = expr { &cast.expr } else { expr }
}

/// A type in C.
pub(super) fn type_name(unit: &Unit, ty: &Type) -> Result<String, String> {
    let Type::Path(path) = ty else { return unit.error(ty.span(), "such type") };
    let Some(name) = path.path.get_ident() else { return unit.error(ty.span(), "such type") };
    Ok(match name.to_string().as_str() {
        "Real" => unit.real.to_owned(),
        "Rough" => "float".to_owned(),
        "u32" | "usize" => "uint".to_owned(),
        "i32" => "int".to_owned(),
        // Of the interface: the host's own types.
        "f64" => "double".to_owned(),
        "f32" => "float".to_owned(),
        "u64" => "ulong".to_owned(),
        "u8" => "uchar".to_owned(),
        name => name.to_owned(),
    })
}

/// A function's name in C.
pub(super) fn renamed(name: &str) -> String {
    RENAMED.iter().find(|(from, _)| *from == name).map_or(name, |(_, to)| to).to_owned()
}
