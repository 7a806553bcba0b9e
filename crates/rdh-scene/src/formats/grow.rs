//! Growing lists by what a file says, where running out of memory is an error and not an abort.

use crate::error::{Error, Result};

/// Appends to a list.
pub(super) fn push<T>(list: &mut Vec<T>, item: T) -> Result<()> {
    if list.len() == list.capacity() {
        list.try_reserve(1).map_err(|_| out_of_memory())?;
    }
    list.push(item);
    Ok(())
}

/// Makes room for so many more, exactly if the list is empty. The caller has made sure that the file can hold them.
pub(super) fn reserve<T>(list: &mut Vec<T>, count: usize) -> Result<()> {
    // Exactly each time, a list that grows in many steps would be copied as often.
    let reserved = if list.is_empty() { list.try_reserve_exact(count) } else { list.try_reserve(count) };
    reserved.map_err(|_| out_of_memory())
}

fn out_of_memory() -> Error {
    Error::whole("out of memory")
}
