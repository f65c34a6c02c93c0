#include "decoder_glsl/gl_context.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <algorithm>
#include <array>
#include <map>
#include <string_view>
#include <utility>
#include <vector>

namespace tessera {
namespace {

bool lists(const char* extensions, std::string_view name) {
    for (std::string_view rest = extensions == nullptr ? "" : extensions; !rest.empty();) {
        const std::size_t end = rest.find(' ');
        if (rest.substr(0, end) == name)
            return true;
        rest = end == std::string_view::npos ? std::string_view() : rest.substr(end + 1);
    }
    return false;
}

// Uses eglGetProcAddress, because libepoxy ends the process if a function does not exist.
template <class Function> Function egl_function(const char* name) {
    return reinterpret_cast<Function>(eglGetProcAddress(name));
}

std::string egl_error() {
    static const std::map<EGLint, const char*> names = {
        {EGL_SUCCESS, "no reason given"},         {EGL_NOT_INITIALIZED, "EGL_NOT_INITIALIZED"},
        {EGL_BAD_ACCESS, "EGL_BAD_ACCESS"},       {EGL_BAD_ALLOC, "EGL_BAD_ALLOC"},
        {EGL_BAD_ATTRIBUTE, "EGL_BAD_ATTRIBUTE"}, {EGL_BAD_CONFIG, "EGL_BAD_CONFIG"},
        {EGL_BAD_CONTEXT, "EGL_BAD_CONTEXT"},     {EGL_BAD_DISPLAY, "EGL_BAD_DISPLAY"},
        {EGL_BAD_MATCH, "EGL_BAD_MATCH"},         {EGL_BAD_PARAMETER, "EGL_BAD_PARAMETER"},
        {EGL_CONTEXT_LOST, "EGL_CONTEXT_LOST"}};
    const EGLint code = eglGetError();
    const auto name = names.find(code);
    return name != names.end() ? name->second : "EGL error " + std::to_string(code);
}

std::string gl_string(GLenum name) {
    const GLubyte* text = glGetString(name);
    return text == nullptr ? "" : reinterpret_cast<const char*>(text);
}

bool names_software(std::string renderer) {
    std::transform(renderer.begin(), renderer.end(), renderer.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
    static constexpr std::array names = {"llvmpipe", "softpipe", "swrast", "software rasterizer",
                                         "swiftshader"};
    return std::any_of(names.begin(), names.end(),
                       [&](const char* name) { return renderer.find(name) != std::string::npos; });
}

class Context {
public:
    Context(EGLDisplay display, EGLContext context) : display_(display), context_(context) {}
    Context(Context&& other) noexcept
        : display_(other.display_), context_(std::exchange(other.context_, EGL_NO_CONTEXT)) {}
    Context& operator=(Context&&) = delete;
    ~Context() {
        if (context_ == EGL_NO_CONTEXT)
            return;
        if (eglGetCurrentContext() == context_)
            eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        eglDestroyContext(display_, context_);
    }
    Status make_current() const {
        if (!eglBindAPI(EGL_OPENGL_API) ||
            !eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_))
            return {ErrorCode::runtime, "cannot make the context current: " + egl_error()};
        return {};
    }

private:
    EGLDisplay display_;
    EGLContext context_;
};

struct Candidate {
    std::string name; // for messages
    EGLDisplay display = EGL_NO_DISPLAY;
    bool fallback = false; // not tried if there is a software context already
};

std::vector<Candidate> list_devices(const char* client_extensions) {
    if (!lists(client_extensions, "EGL_EXT_platform_device") ||
        !(lists(client_extensions, "EGL_EXT_device_enumeration") ||
          lists(client_extensions, "EGL_EXT_device_base")))
        return {};
    const auto query_devices = egl_function<PFNEGLQUERYDEVICESEXTPROC>("eglQueryDevicesEXT");
    const auto query_string =
        egl_function<PFNEGLQUERYDEVICESTRINGEXTPROC>("eglQueryDeviceStringEXT");
    const auto get_display =
        egl_function<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
    EGLint count = 0;
    if (query_devices == nullptr || get_display == nullptr || !query_devices(0, nullptr, &count) ||
        count <= 0)
        return {};
    std::vector<EGLDeviceEXT> devices(static_cast<std::size_t>(count));
    if (!query_devices(count, devices.data(), &count))
        return {};
    devices.resize(static_cast<std::size_t>(std::max<EGLint>(count, 0)));

    std::vector<Candidate> candidates;
    for (std::size_t i = 0; i < devices.size(); ++i) {
        Candidate candidate;
        candidate.name = "EGL device " + std::to_string(i);
        candidate.display = get_display(EGL_PLATFORM_DEVICE_EXT, devices[i], nullptr);
        candidate.fallback =
            query_string != nullptr &&
            lists(query_string(devices[i], EGL_EXTENSIONS), "EGL_MESA_device_software");
        if (candidate.display != EGL_NO_DISPLAY)
            candidates.push_back(std::move(candidate));
    }
    return candidates;
}

// Lists the displays in the order in which they are tried.
std::vector<Candidate> list_candidates() {
    const char* extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    std::vector<Candidate> candidates = list_devices(extensions);
    const auto software = std::stable_partition(candidates.begin(), candidates.end(),
                                                [](const Candidate& c) { return !c.fallback; });
    const auto get_display =
        egl_function<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
    if (lists(extensions, "EGL_MESA_platform_surfaceless") && get_display != nullptr) {
        const EGLDisplay display =
            get_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
        if (display != EGL_NO_DISPLAY)
            candidates.insert(software,
                              {.name = "Mesa's surfaceless platform", .display = display});
    }
    if (const EGLDisplay display = eglGetDisplay(EGL_DEFAULT_DISPLAY); display != EGL_NO_DISPLAY)
        candidates.push_back(
            {.name = "the default EGL display", .display = display, .fallback = true});
    return candidates;
}

// Creates a context of OpenGL 4.5. If `version` is false, the context has any version, which tells
// what the device offers.
Result<Context> create_context(EGLDisplay display, bool version) {
    const char* extensions = eglQueryString(display, EGL_EXTENSIONS);
    if (!lists(extensions, "EGL_KHR_surfaceless_context"))
        return Status(ErrorCode::unsupported, "the display has no contexts without a surface");
    if (!eglBindAPI(EGL_OPENGL_API))
        return Status(ErrorCode::unsupported, "the display has no desktop OpenGL");
    EGLConfig config = EGL_NO_CONFIG_KHR;
    if (!lists(extensions, "EGL_KHR_no_config_context")) {
        const EGLint wanted[] = {EGL_SURFACE_TYPE, EGL_DONT_CARE, EGL_RENDERABLE_TYPE,
                                 EGL_OPENGL_BIT, EGL_NONE};
        EGLint count = 0;
        if (!eglChooseConfig(display, wanted, &config, 1, &count) || count < 1)
            return Status(ErrorCode::unsupported,
                          "the display has no configuration for desktop OpenGL");
    }
    const EGLint core45[] = {EGL_CONTEXT_MAJOR_VERSION,
                             4,
                             EGL_CONTEXT_MINOR_VERSION,
                             5,
                             EGL_CONTEXT_OPENGL_PROFILE_MASK,
                             EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                             EGL_NONE};
    const EGLint any[] = {EGL_NONE};
    const EGLContext context =
        eglCreateContext(display, config, EGL_NO_CONTEXT, version ? core45 : any);
    if (context == EGL_NO_CONTEXT)
        return Status(ErrorCode::unsupported, "no OpenGL context: " + egl_error());
    return Context(display, context);
}

Status too_old(EGLDisplay display, const Status& reason) {
    const Result<Context> context = create_context(display, false);
    if (!context || !context->make_current())
        return reason;
    return {ErrorCode::unsupported,
            "OpenGL 4.5 is needed, this device offers " + gl_string(GL_VERSION)};
}

} // namespace

struct HeadlessContext::State {
    Context context;
    std::string vendor, device, version;

    static Result<std::unique_ptr<State>> open(EGLDisplay display) {
        // eglTerminate is never called: a process has one display per device, which other code may
        // use too, and EGL does not count its users. A second eglInitialize does nothing.
        if (!eglInitialize(display, nullptr, nullptr))
            return Status(ErrorCode::unsupported, "eglInitialize failed: " + egl_error());
        Result<Context> context = create_context(display, true);
        if (!context)
            return too_old(display, context.status());
        TESSERA_TRY(context->make_current());
        return std::make_unique<State>(State{std::move(*context), gl_string(GL_VENDOR),
                                             gl_string(GL_RENDERER), gl_string(GL_VERSION)});
    }
};

Result<HeadlessContext> HeadlessContext::create() {
    if (!epoxy_has_egl())
        return Status(ErrorCode::unsupported, "no EGL library (libEGL.so.1)");
    std::string reasons;
    std::unique_ptr<State> software;
    for (const Candidate& candidate : list_candidates()) {
        if (software != nullptr && candidate.fallback)
            continue;
        Result<std::unique_ptr<State>> state = State::open(candidate.display);
        if (!state) {
            reasons +=
                (reasons.empty() ? "" : "; ") + candidate.name + ": " + state.status().message();
            continue;
        }
        if (!names_software((*state)->device))
            return HeadlessContext(std::move(*state));
        if (software == nullptr) // kept, because a GPU may still follow
            software = std::move(*state);
    }
    if (software != nullptr) {
        TESSERA_TRY(software->context.make_current());
        return HeadlessContext(std::move(software));
    }
    return Status(ErrorCode::unsupported,
                  reasons.empty() ? "no EGL display" : "no OpenGL context: " + reasons);
}

HeadlessContext::HeadlessContext(std::unique_ptr<State> state) : state_(std::move(state)) {}
HeadlessContext::HeadlessContext(HeadlessContext&&) noexcept = default;
HeadlessContext& HeadlessContext::operator=(HeadlessContext&&) noexcept = default;
HeadlessContext::~HeadlessContext() = default;

Status HeadlessContext::make_current() const {
    return state_->context.make_current();
}
const std::string& HeadlessContext::vendor() const {
    return state_->vendor;
}
const std::string& HeadlessContext::device() const {
    return state_->device;
}
const std::string& HeadlessContext::version() const {
    return state_->version;
}
bool HeadlessContext::is_software() const {
    return names_software(state_->device);
}

} // namespace tessera
