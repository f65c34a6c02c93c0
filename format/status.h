// Errors as values. No exception crosses a public header of Tessera.
#pragma once

#include <optional>
#include <string>
#include <utility>

// What public headers declare can be seen from outside a shared library; nothing else can.
#if defined(__GNUC__)
#define TESSERA_PUBLIC [[gnu::visibility("default")]]
#else
#define TESSERA_PUBLIC
#endif

namespace TESSERA_PUBLIC tessera {

// What kind of thing went wrong. The numbers are the tool's exit codes and stay fixed.
enum class ErrorCode {
    ok = 0,
    bad_argument = 1, // the caller asked for something that makes no sense
    io = 2,           // the operating system refused a read or a write
    invalid_file = 3, // the bytes are not what FORMAT.md (or the file's own kind) allows
    runtime = 4,      // out of memory, a failed self-check
    unsupported = 5,  // valid, but this version cannot do it
    difference = 7,   // a comparison missed its threshold
};

// Success, or a code with one plain sentence that names the file and the place.
class [[nodiscard]] Status {
public:
    Status() = default;
    Status(ErrorCode code, std::string message) : code_(code), message_(std::move(message)) {}

    bool ok() const { return code_ == ErrorCode::ok; }
    explicit operator bool() const { return ok(); }
    ErrorCode code() const { return code_; }
    const std::string& message() const { return message_; }

    // The same error with "context: " before its message; success stays success.
    Status with_context(const std::string& context) const {
        return ok() ? Status() : Status(code_, context + ": " + message_);
    }

private:
    ErrorCode code_ = ErrorCode::ok;
    std::string message_;
};

// A value, or the Status that says why there is none.
template <class T> class [[nodiscard]] Result {
public:
    Result(T value) : value_(std::move(value)) {}
    Result(Status status) : status_(std::move(status)) {}

    bool ok() const { return value_.has_value(); }
    explicit operator bool() const { return ok(); }
    const Status& status() const { return status_; }
    // Precondition for these: ok().
    T& value() { return *value_; }
    const T& value() const { return *value_; }
    T& operator*() { return *value_; }
    const T& operator*() const { return *value_; }
    T* operator->() { return &*value_; }
    const T* operator->() const { return &*value_; }

private:
    Status status_;
    std::optional<T> value_;
};

// Leaves the enclosing function with the error of `expression`, if it has one. The counter keeps the
// names of nested uses (a lambda inside the expression) apart.
#define TESSERA_TRY(expression) TESSERA_TRY_NUMBERED(expression, __COUNTER__)
#define TESSERA_TRY_NUMBERED(expression, number) TESSERA_TRY_NAMED(expression, number)
#define TESSERA_TRY_NAMED(expression, number) TESSERA_TRY_STATUS(expression, try_status_##number)
#define TESSERA_TRY_STATUS(expression, name)                                                       \
    do {                                                                                           \
        if (::tessera::Status name = (expression); !name.ok())                                     \
            return name;                                                                           \
    } while (false)

} // namespace tessera
