//! How a table of kernels becomes Rust: for each kernel a struct of its arguments, which are set in the table's order.

/// Kernels, and groups of parameters that are a struct on the device. The parameters are
/// - `input name: T`: a buffer of `T` that is read;
/// - `output name: T`: one that is written;
/// - `atomic name: T`: one that work-items write at once;
/// - `value name: T`: a number;
/// - `group name: G`: the parameters of a group.
///
/// `[T; 2]` and `[T; 4]` are the device's vectors; of `[T; 3]`, which has no vector of its size, a buffer is one of numbers there.
macro_rules! kernels {
    ($(
        $(#[$attribute:meta])*
        $word:ident $Name:ident $(= $kernel:ident)? {
            $($(#[$field_attribute:meta])* $kind:ident $field:ident: $ty:tt,)*
        }
    )*) => {$(
        $(#[$attribute])*
        #[derive(Clone, Copy)]
        pub(crate) struct $Name<'a> {
            $($(#[$field_attribute])* pub(crate) $field: crate::interface::table::argument!('a $kind $ty),)*
        }

        impl crate::launch::Argument for $Name<'_> {
            fn set(&self, launch: &mut crate::launch::Launch<'_>) -> laguerre_core::Result<()> {
                $(self.$field.set(launch)?;)*
                Ok(())
            }
        }

        $(
            impl crate::launch::Arguments for $Name<'_> {
                const KERNEL: &'static str = stringify!($kernel);
                type Kernel = $Name<'static>;
            }
        )?
    )*};
}
pub(crate) use kernels;

/// The type of an argument.
macro_rules! argument {
    ($life:lifetime value $ty:tt) => { $ty };
    ($life:lifetime group $Name:ident) => { $Name<$life> };
    ($life:lifetime $buffer:ident $ty:tt) => { &$life crate::buffer::Room<$ty> };
}
pub(crate) use argument;
