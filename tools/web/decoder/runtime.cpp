// What the C++ library would do with text on a terminal and with exceptions: here, whatever would end the
// program stops the instance, and tessera.js makes an Error of it.
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
