#include "view/gl.h"

#include "scene/fields.h"

namespace oilskin::demo {
namespace {

/// Throws SceneError with what the compiler says.
GLuint compile(const Gl& gl, GLenum kind, const std::string& text) {
  const GLuint id = gl.CreateShader(kind);
  const char* source = text.c_str();
  gl.ShaderSource(id, 1, &source, nullptr);
  gl.CompileShader(id);
  GLint done = 0;
  gl.GetShaderiv(id, GL_COMPILE_STATUS, &done);
  if (done != 0) return id;
  char log[1000] = "";
  gl.GetShaderInfoLog(id, sizeof log, nullptr, log);
  throw SceneError(std::string("view: a shader does not compile on this graphics card: ") + log);
}

}  // namespace

Gl::Gl(Load load) {
#define OILSKIN_GL_LOAD(type, name)                             \
  name = reinterpret_cast<PFNGL##type##PROC>(load("gl" #name)); \
  if ((name) == nullptr) throw SceneError("view: OpenGL has no gl" #name);
  OILSKIN_GL_FUNCTIONS(OILSKIN_GL_LOAD)
#undef OILSKIN_GL_LOAD
}

Program::Program(const Gl& gl, const std::string& vertex, const std::string& fragment) : gl_(gl) {
  const GLuint parts[2] = {compile(gl, GL_VERTEX_SHADER, vertex), compile(gl, GL_FRAGMENT_SHADER, fragment)};
  id_ = gl.CreateProgram();
  for (const GLuint part : parts) gl.AttachShader(id_, part);
  gl.LinkProgram(id_);
  for (const GLuint part : parts) gl.DeleteShader(part);
  GLint done = 0;
  gl.GetProgramiv(id_, GL_LINK_STATUS, &done);
  if (done != 0) return;
  char log[1000] = "";
  gl.GetProgramInfoLog(id_, sizeof log, nullptr, log);
  throw SceneError(std::string("view: shaders do not fit together on this graphics card: ") + log);
}

Program::~Program() {
  gl_.DeleteProgram(id_);
}

void Program::set(const char* name, int value) const {
  gl_.Uniform1i(place(name), value);
}

void Program::set(const char* name, float value) const {
  gl_.Uniform1f(place(name), value);
}

void Program::set_vec3(const char* name, const float* values, int count) const {
  gl_.Uniform3fv(place(name), count, values);
}

void Program::set_vec4(const char* name, const float* values) const {
  gl_.Uniform4fv(place(name), 1, values);
}

void Program::set_mat4(const char* name, const float* values) const {
  gl_.UniformMatrix4fv(place(name), 1, GL_FALSE, values);
}

Vertices::Vertices(const Gl& gl, const Layout& layout, bool per_instance) : gl_(gl) {
  gl.GenVertexArrays(1, &array_);
  gl.GenBuffers(1, &vertices_);
  gl.GenBuffers(1, &indices_);
  gl.BindVertexArray(array_);
  gl.BindBuffer(GL_ARRAY_BUFFER, vertices_);
  std::size_t floats = 0, at = 0;
  for (const int size : layout) floats += static_cast<std::size_t>(size);
  for (GLuint k = 0; k < layout.size(); ++k) {
    gl.EnableVertexAttribArray(k);
    gl.VertexAttribPointer(k, layout[k], GL_FLOAT, GL_FALSE, static_cast<GLsizei>(floats * sizeof(float)),
                           reinterpret_cast<const void*>(at * sizeof(float)));
    if (per_instance) gl.VertexAttribDivisor(k, 1);
    at += static_cast<std::size_t>(layout[k]);
  }
  gl.BindVertexArray(0);
}

Vertices::~Vertices() {
  gl_.DeleteVertexArrays(1, &array_);
  gl_.DeleteBuffers(1, &vertices_);
  gl_.DeleteBuffers(1, &indices_);
}

void Vertices::fill(const void* data, std::size_t bytes) {
  gl_.BindBuffer(GL_ARRAY_BUFFER, vertices_);
  gl_.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(bytes), data, GL_STREAM_DRAW);
}

void Vertices::index(const std::vector<std::uint32_t>& indices) {
  gl_.BindVertexArray(array_);
  gl_.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_);
  gl_.BufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(indices.size() * sizeof(std::uint32_t)),
                 indices.data(), GL_STREAM_DRAW);
  gl_.BindVertexArray(0);
  count_ = indices.size();
}

void Vertices::draw_indexed(GLenum kind) const {
  if (count_ == 0) return;
  gl_.BindVertexArray(array_);
  gl_.DrawElements(kind, static_cast<GLsizei>(count_), GL_UNSIGNED_INT, nullptr);
}

void Vertices::draw_squares(std::size_t count) const {
  if (count == 0) return;
  gl_.BindVertexArray(array_);
  gl_.DrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(count));
}

void Vertices::draw(GLenum kind, std::size_t count) const {
  if (count == 0) return;
  gl_.BindVertexArray(array_);
  gl_.DrawArrays(kind, 0, static_cast<GLsizei>(count));
}

}  // namespace oilskin::demo
