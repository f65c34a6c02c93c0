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

// What kind of thing went wrong. The numbers are the tool's exit codes and stay fixed; over_budget, which
// whoever allows more memory can mend, exits with the code of unsupported.
enum class ErrorCode {
    ok = 0,
    bad_argument = 1,  // the caller asked for something that makes no sense
    io = 2,            // the operating system refused a read or a write
    invalid_file = 3,  // the bytes are not what FORMAT.md (or the file's own kind) allows
    runtime = 4,       // out of memory, a failed self-check
    unsupported = 5,   // valid, but this version cannot do it
    target_missed = 6, // a file was made, but not as good as it had to be
    difference = 7,    // a comparison missed its threshold
    over_budget = 8,   // more memory is needed than the caller allows
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

// A value, or the Status that says why there is none: ok() and status().ok() are always the same.
template <class T> class [[nodiscard]] Result {
public:
    Result(T value) : value_(std::move(value)) {}
    // `status` should be an error. Success without a value is a mistake of whoever wrote the call, and
    // becomes an error of its own, so that nobody looks at a value that is not there.
    Result(Status status) : status_(std::move(status)) {
        if (status_.ok())
            status_ = {ErrorCode::runtime, "internal error: a result without value"};
    }

    bool ok() const { return value_.has_value(); }
    explicit operator bool() const { return ok(); }
    const Status& status() const { return status_; }
    // The same value, or the same error with "context: " before its message.
    Result with_context(const std::string& context) && {
        status_ = status_.with_context(context);
        return std::move(*this);
    }
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

namespace detail {
// What TESSERA_TRY looks at.
inline Status status_of(Status status) {
    return status;
}
template <class T> Status status_of(const Result<T>& result) {
    return result.status();
}
} // namespace detail

// Leaves the enclosing function with the error of `expression`, a Status or a Result, if it has one.
// The counter keeps the names of nested uses (a lambda inside the expression) apart.
#define TESSERA_TRY(...) TESSERA_TRY_STATUS(TESSERA_TRY_NAME(__COUNTER__), __VA_ARGS__)
// The same for a Result whose value is wanted: TESSERA_TRY_ASSIGN(const auto box, parse_box(text));
// The value is moved out. Two statements: it needs the braces of an if or a loop around it.
#define TESSERA_TRY_ASSIGN(declaration, ...)                                                       \
    TESSERA_TRY_VALUE(declaration, TESSERA_TRY_NAME(__COUNTER__), __VA_ARGS__)

#define TESSERA_TRY_NAME(number) TESSERA_TRY_JOIN(number)
#define TESSERA_TRY_JOIN(number) tessera_try_##number
#define TESSERA_TRY_STATUS(name, ...)                                                              \
    do {                                                                                           \
        if (::tessera::Status name = ::tessera::detail::status_of(__VA_ARGS__); !name.ok())        \
            return name;                                                                           \
    } while (false)
#define TESSERA_TRY_VALUE(declaration, name, ...)                                                  \
    auto name = (__VA_ARGS__);                                                                     \
    if (!name.ok())                                                                                \
        return name.status();                                                                      \
    declaration = std::move(*name)

} // namespace tessera
