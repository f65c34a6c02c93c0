// Errors as values. No exception crosses a public header of Tessera.
#pragma once

#include <optional>
#include <string>
#include <utility>

// Declarations of public headers are visible outside a shared library. All others are hidden.
#if defined(__GNUC__)
#define TESSERA_PUBLIC [[gnu::visibility("default")]]
#else
#define TESSERA_PUBLIC
#endif

namespace TESSERA_PUBLIC tessera {

// The kinds of errors. The numbers never change. They are the tool's exit codes, except that the
// tool exits with the code of unsupported for over_budget.
enum class ErrorCode {
    ok = 0,
    bad_argument = 1,  // the arguments are not allowed or contradict each other
    io = 2,            // a read or a write failed
    invalid_file = 3,  // the bytes break the rules of FORMAT.md, or of another file format
    runtime = 4,       // out of memory, or a failed self-check
    unsupported = 5,   // valid, but this version cannot do it
    target_missed = 6, // a file was written that misses its target
    difference = 7,    // a comparison missed its threshold
    over_budget = 8,   // the work needs more memory than the caller allows
};

// Success, or a code with one sentence that names the file and the position.
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

// A value, or the Status that says why there is none. ok() and status().ok() are always equal.
template <class T> class [[nodiscard]] Result {
public:
    Result(T value) : value_(std::move(value)) {}
    // `status` must be an error. Success without a value is a bug in the caller. It becomes an
    // error, so that nobody reads a value that does not exist.
    Result(Status status) : status_(std::move(status)) {
        if (status_.ok())
            status_ = {ErrorCode::runtime, "internal error: a result without a value"};
    }

    bool ok() const { return value_.has_value(); }
    explicit operator bool() const { return ok(); }
    const Status& status() const { return status_; }
    // The same value, or the same error with "context: " before its message.
    Result with_context(const std::string& context) && {
        status_ = status_.with_context(context);
        return std::move(*this);
    }
    // Precondition of these six: ok().
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
inline Status status_of(Status status) {
    return status;
}
template <class T> Status status_of(const Result<T>& result) {
    return result.status();
}
} // namespace detail

// TESSERA_TRY(expression) evaluates a Status or a Result and returns its error, if it has one, from
// the enclosing function. The counter makes the names of nested uses (in a lambda inside the
// expression) distinct.
#define TESSERA_TRY(...) TESSERA_TRY_STATUS(TESSERA_TRY_NAME(__COUNTER__), __VA_ARGS__)
// The same for a Result whose value is needed: TESSERA_TRY_ASSIGN(const auto box, parse_box(text));
// The value is moved out. The macro is several statements, so an `if` or a loop needs braces around
// it.
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
