#include <view/egl_context.h>

#include <wavelet/base/error.h>

#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <dlfcn.h>

namespace haarlight::view {
namespace {

constexpr const char* remedy =
    " (Debian: libegl1, libgles2 and libgl1-mesa-dri draw without a graphics card)";

[[noreturn]] void refuse(const std::string& trouble) {
  throw_output_error("EGL", trouble + remedy);
}

/// libepoxy ends the process where the library of the calls is missing, so it is looked for first.
bool has_gles_library() {
  void* const library = dlopen("libGLESv2.so.2", RTLD_LAZY | RTLD_LOCAL);
  if (library != nullptr)
    dlclose(library);
  return library != nullptr;
}

EGLDisplay surfaceless_display() {
  if (!epoxy_has_egl())
    refuse("is not installed");
  if (!has_gles_library())
    refuse("is there, but libGLESv2.so.2 is not");
  if (!epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_base") ||
      !epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless"))
    refuse("offers no surfaceless platform");
  return eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr);
}

} // namespace

struct EglContext::Handles {
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;

  Handles() = default;
  Handles(const Handles&) = delete;
  Handles& operator=(const Handles&) = delete;
  ~Handles() {
    if (display == EGL_NO_DISPLAY)
      return;
    eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    if (context != EGL_NO_CONTEXT)
      eglDestroyContext(display, context);
    eglTerminate(display);
  }

  void open_display() {
    display = surfaceless_display();
    if (display == EGL_NO_DISPLAY || eglInitialize(display, nullptr, nullptr) == EGL_FALSE)
      refuse("finds no device to draw with");
  }

  void make_context() {
    const EGLint wanted[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE,
                             EGL_OPENGL_ES3_BIT, EGL_NONE};
    const EGLint version[] = {EGL_CONTEXT_CLIENT_VERSION, 3, EGL_NONE};
    EGLConfig config = nullptr;
    EGLint count = 0;
    if (eglBindAPI(EGL_OPENGL_ES_API) == EGL_FALSE ||
        eglChooseConfig(display, wanted, &config, 1, &count) == EGL_FALSE || count == 0)
      refuse("offers no OpenGL ES 3.0");
    context = eglCreateContext(display, config, EGL_NO_CONTEXT, version);
    if (context == EGL_NO_CONTEXT ||
        eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) == EGL_FALSE)
      refuse("makes no context of OpenGL ES 3.0");
  }
};

EglContext::EglContext() : m_handles(std::make_unique<Handles>()) {
  m_handles->open_display();
  m_handles->make_context();
  if (!epoxy_has_gl_extension("GL_EXT_color_buffer_float"))
    refuse("draws to no float images (GL_EXT_color_buffer_float)");
}

EglContext::~EglContext() = default;

std::string EglContext::renderer() const {
  return reinterpret_cast<const char*>(glGetString(GL_RENDERER));
}

} // namespace haarlight::view
