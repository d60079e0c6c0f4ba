// A heap for large models: fewer pages, and none given back and asked for again.
#pragma once

namespace asperity::command {

/// Prepares the heap for blocks of many megabytes. Without it most of the time that two models take to load goes to the
/// kernel, which hands out and clears one page of 4 KiB after the other. Half a gigabyte of addresses gets large pages,
/// where the system has them; memory is taken only as it is used. To be called first, while there is one thread. Does
/// nothing where this process may have only so much memory, or with another C library than glibc.
void prepare_heap() noexcept;

/// Lets threads that are started later take memory from the same heap.
void share_heap() noexcept;

/// Gives back what prepare_heap() took and nobody has used: before memory is locked, since what is locked is filled.
void trim_heap() noexcept;

}  // namespace asperity::command
