// Replaces the parts of the C++ runtime that would print to a terminal or throw exceptions.
// Anything that would end the program traps, which stops the instance; tessera.js reports this as
// an Error.
#include <cstddef>
#include <cstdlib>
#include <new>

namespace {

void* allocate(std::size_t bytes) {
    void* const memory = std::malloc(bytes > 0 ? bytes : 1);
    if (memory == nullptr)
        __builtin_trap();
    return memory;
}

} // namespace

void* operator new(std::size_t bytes) {
    return allocate(bytes);
}
void* operator new[](std::size_t bytes) {
    return allocate(bytes);
}
void operator delete(void* memory) noexcept {
    std::free(memory);
}
void operator delete[](void* memory) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
    std::free(memory);
}
void operator delete[](void* memory, std::size_t) noexcept {
    std::free(memory);
}

void std::__libcpp_verbose_abort(const char*, ...) {
    __builtin_trap();
}

extern "C" {
void* __cxa_allocate_exception(std::size_t) noexcept {
    __builtin_trap();
}
[[noreturn]] void __cxa_throw(void*, void*, void (*)(void*)) {
    __builtin_trap();
}
void __cxa_pure_virtual() {
    __builtin_trap();
}
void abort_message(const char*, ...) {
    __builtin_trap();
}
}
