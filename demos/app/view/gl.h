/// OpenGL 3.3 and what the window needs of it: functions, programs, lists of vertices.
#pragma once

#include <GL/glcorearb.h>

#include <cstddef>
#include <string>
#include <vector>

namespace oilskin::demo {

#define OILSKIN_GL_FUNCTIONS(F)                       \
  F(ATTACHSHADER, AttachShader)                       \
  F(BINDBUFFER, BindBuffer)                           \
  F(BINDVERTEXARRAY, BindVertexArray)                 \
  F(BLENDFUNC, BlendFunc)                             \
  F(BUFFERDATA, BufferData)                           \
  F(CLEAR, Clear)                                     \
  F(CLEARCOLOR, ClearColor)                           \
  F(COLORMASK, ColorMask)                             \
  F(COMPILESHADER, CompileShader)                     \
  F(CREATEPROGRAM, CreateProgram)                     \
  F(CREATESHADER, CreateShader)                       \
  F(DELETEBUFFERS, DeleteBuffers)                     \
  F(DELETEPROGRAM, DeleteProgram)                     \
  F(DELETESHADER, DeleteShader)                       \
  F(DELETEVERTEXARRAYS, DeleteVertexArrays)           \
  F(DEPTHFUNC, DepthFunc)                             \
  F(DEPTHMASK, DepthMask)                             \
  F(DISABLE, Disable)                                 \
  F(DRAWARRAYS, DrawArrays)                           \
  F(DRAWARRAYSINSTANCED, DrawArraysInstanced)         \
  F(DRAWELEMENTS, DrawElements)                       \
  F(ENABLE, Enable)                                   \
  F(ENABLEVERTEXATTRIBARRAY, EnableVertexAttribArray) \
  F(GENBUFFERS, GenBuffers)                           \
  F(GENVERTEXARRAYS, GenVertexArrays)                 \
  F(GETPROGRAMINFOLOG, GetProgramInfoLog)             \
  F(GETPROGRAMIV, GetProgramiv)                       \
  F(GETSHADERINFOLOG, GetShaderInfoLog)               \
  F(GETSHADERIV, GetShaderiv)                         \
  F(GETUNIFORMLOCATION, GetUniformLocation)           \
  F(LINKPROGRAM, LinkProgram)                         \
  F(PIXELSTOREI, PixelStorei)                         \
  F(READPIXELS, ReadPixels)                           \
  F(SHADERSOURCE, ShaderSource)                       \
  F(UNIFORM1F, Uniform1f)                             \
  F(UNIFORM1I, Uniform1i)                             \
  F(UNIFORM3FV, Uniform3fv)                           \
  F(UNIFORM4FV, Uniform4fv)                           \
  F(UNIFORMMATRIX4FV, UniformMatrix4fv)               \
  F(USEPROGRAM, UseProgram)                           \
  F(VERTEXATTRIBDIVISOR, VertexAttribDivisor)         \
  F(VERTEXATTRIBPOINTER, VertexAttribPointer)         \
  F(VIEWPORT, Viewport)

/// The functions of the current context.
struct Gl {
#define OILSKIN_GL_MEMBER(type, name) PFNGL##type##PROC name = nullptr;
  OILSKIN_GL_FUNCTIONS(OILSKIN_GL_MEMBER)
#undef OILSKIN_GL_MEMBER

  using Load = void (*(*)(const char*))();
  /// Throws SceneError with the name of a function that there is not.
  explicit Gl(Load load);
};

/// A vertex and a fragment shader.
class Program {
 public:
  /// Throws SceneError with what the compiler says.
  Program(const Gl& gl, const std::string& vertex, const std::string& fragment);
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  void use() const { gl_.UseProgram(id_); }
  void set(const char* name, int value) const;
  void set(const char* name, float value) const;
  void set_vec3(const char* name, const float* values, int count = 1) const;
  void set_vec4(const char* name, const float* values) const;
  /// Column by column, as Eigen keeps it.
  void set_mat4(const char* name, const float* values) const;

 private:
  GLint place(const char* name) const { return gl_.GetUniformLocation(id_, name); }
  const Gl& gl_;
  GLuint id_ = 0;
};

/// Floats per attribute of a vertex, in order.
using Layout = std::vector<int>;

/// Vertices and indices on the graphics card.
class Vertices {
 public:
  /// `per_instance`: the attributes advance once per instance, not once per vertex.
  Vertices(const Gl& gl, const Layout& layout, bool per_instance = false);
  ~Vertices();
  Vertices(const Vertices&) = delete;
  Vertices& operator=(const Vertices&) = delete;

  /// `bytes` of vertices.
  void fill(const void* data, std::size_t bytes);
  void index(const std::vector<std::uint32_t>& indices);
  /// What `kind` says of all indices.
  void draw_indexed(GLenum kind) const;
  /// Squares of four vertices, one per instance.
  void draw_squares(std::size_t count) const;
  /// Vertices in their order.
  void draw(GLenum kind, std::size_t count) const;

 private:
  const Gl& gl_;
  GLuint array_ = 0, vertices_ = 0, indices_ = 0;
  std::size_t count_ = 0;  ///< of indices
};

}  // namespace oilskin::demo
