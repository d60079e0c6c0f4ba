// OpenGL's entry points, loaded at run time. What the core profile and ES both have under one name stands in one table.
#pragma once

#include <GL/glcorearb.h>
#include <string>

// name, and name in capitals as in its function pointer type
#define ASPERITY_GL_FUNCTIONS(X)                      \
  X(ActiveTexture, ACTIVETEXTURE)                     \
  X(AttachShader, ATTACHSHADER)                       \
  X(BeginQuery, BEGINQUERY)                           \
  X(BindBuffer, BINDBUFFER)                           \
  X(BindBufferBase, BINDBUFFERBASE)                   \
  X(BindBufferRange, BINDBUFFERRANGE)                 \
  X(BindFramebuffer, BINDFRAMEBUFFER)                 \
  X(BindImageTexture, BINDIMAGETEXTURE)               \
  X(BindTexture, BINDTEXTURE)                         \
  X(BindVertexArray, BINDVERTEXARRAY)                 \
  X(BlendEquation, BLENDEQUATION)                     \
  X(BufferData, BUFFERDATA)                           \
  X(BufferSubData, BUFFERSUBDATA)                     \
  X(CheckFramebufferStatus, CHECKFRAMEBUFFERSTATUS)   \
  X(Clear, CLEAR)                                     \
  X(ClearBufferfv, CLEARBUFFERFV)                     \
  X(ClearDepthf, CLEARDEPTHF)                         \
  X(ClientWaitSync, CLIENTWAITSYNC)                   \
  X(ColorMask, COLORMASK)                             \
  X(CompileShader, COMPILESHADER)                     \
  X(CreateProgram, CREATEPROGRAM)                     \
  X(CreateShader, CREATESHADER)                       \
  X(DeleteBuffers, DELETEBUFFERS)                     \
  X(DeleteFramebuffers, DELETEFRAMEBUFFERS)           \
  X(DeleteProgram, DELETEPROGRAM)                     \
  X(DeleteQueries, DELETEQUERIES)                     \
  X(DeleteShader, DELETESHADER)                       \
  X(DeleteSync, DELETESYNC)                           \
  X(DeleteTextures, DELETETEXTURES)                   \
  X(DeleteVertexArrays, DELETEVERTEXARRAYS)           \
  X(DepthFunc, DEPTHFUNC)                             \
  X(DepthMask, DEPTHMASK)                             \
  X(DepthRangef, DEPTHRANGEF)                         \
  X(Disable, DISABLE)                                 \
  X(DispatchCompute, DISPATCHCOMPUTE)                 \
  X(DrawArrays, DRAWARRAYS)                           \
  X(DrawArraysInstanced, DRAWARRAYSINSTANCED)         \
  X(DrawBuffers, DRAWBUFFERS)                         \
  X(Enable, ENABLE)                                   \
  X(EnableVertexAttribArray, ENABLEVERTEXATTRIBARRAY) \
  X(EndQuery, ENDQUERY)                               \
  X(FenceSync, FENCESYNC)                             \
  X(Finish, FINISH)                                   \
  X(Flush, FLUSH)                                     \
  X(FramebufferTexture2D, FRAMEBUFFERTEXTURE2D)       \
  X(GenBuffers, GENBUFFERS)                           \
  X(GenFramebuffers, GENFRAMEBUFFERS)                 \
  X(GenQueries, GENQUERIES)                           \
  X(GenTextures, GENTEXTURES)                         \
  X(GenVertexArrays, GENVERTEXARRAYS)                 \
  X(GetError, GETERROR)                               \
  X(GetIntegeri_v, GETINTEGERI_V)                     \
  X(GetInteger64v, GETINTEGER64V)                     \
  X(GetIntegerv, GETINTEGERV)                         \
  X(GetProgramInfoLog, GETPROGRAMINFOLOG)             \
  X(GetProgramiv, GETPROGRAMIV)                       \
  X(GetQueryObjectuiv, GETQUERYOBJECTUIV)             \
  X(GetShaderInfoLog, GETSHADERINFOLOG)               \
  X(GetShaderiv, GETSHADERIV)                         \
  X(GetString, GETSTRING)                             \
  X(GetStringi, GETSTRINGI)                           \
  X(GetUniformLocation, GETUNIFORMLOCATION)           \
  X(LinkProgram, LINKPROGRAM)                         \
  X(MapBufferRange, MAPBUFFERRANGE)                   \
  X(MemoryBarrier, MEMORYBARRIER)                     \
  X(PixelStorei, PIXELSTOREI)                         \
  X(ReadBuffer, READBUFFER)                           \
  X(ReadPixels, READPIXELS)                           \
  X(Scissor, SCISSOR)                                 \
  X(ShaderSource, SHADERSOURCE)                       \
  X(TexParameteri, TEXPARAMETERI)                     \
  X(TexStorage2D, TEXSTORAGE2D)                       \
  X(TexSubImage2D, TEXSUBIMAGE2D)                     \
  X(Uniform1f, UNIFORM1F)                             \
  X(Uniform1i, UNIFORM1I)                             \
  X(Uniform1ui, UNIFORM1UI)                           \
  X(Uniform2f, UNIFORM2F)                             \
  X(Uniform2i, UNIFORM2I)                             \
  X(Uniform4f, UNIFORM4F)                             \
  X(UnmapBuffer, UNMAPBUFFER)                         \
  X(UseProgram, USEPROGRAM)                           \
  X(VertexAttribDivisor, VERTEXATTRIBDIVISOR)         \
  X(VertexAttribIPointer, VERTEXATTRIBIPOINTER)       \
  X(VertexAttribPointer, VERTEXATTRIBPOINTER)         \
  X(Viewport, VIEWPORT)

namespace asperity::gl {

class context;

/// Of the context's thread only; a call while the context is not current has no effect that is defined.
struct functions {
#define ASPERITY_GL_DECLARE(name, NAME) PFNGL##NAME##PROC name = nullptr;
  ASPERITY_GL_FUNCTIONS(ASPERITY_GL_DECLARE)
#undef ASPERITY_GL_DECLARE

  // Null where the context has none, whatever eglGetProcAddress says about their names.
  PFNGLBUFFERSTORAGEPROC BufferStorage = nullptr;                    ///< facts().persistent_mapping
  PFNGLCLIPCONTROLPROC ClipControl = nullptr;                        ///< core 4.5, EXT_clip_control
  PFNGLGETGRAPHICSRESETSTATUSPROC GetGraphicsResetStatus = nullptr;  ///< facts().robust
  PFNGLGETQUERYOBJECTUI64VPROC GetQueryObjectui64v = nullptr;        ///< core
  PFNGLQUERYCOUNTERPROC QueryCounter = nullptr;                      ///< core

  using any_function = void (*)();
  /// @param proc_address  eglGetProcAddress
  /// @return names of the entry points that are missing; empty where everything is there
  [[nodiscard]] std::string load(any_function (*proc_address)(const char*));
};

/// Takes every error that waits in the context: their names, empty where there is none. For set-up and tests.
/// @pre current in this thread
[[nodiscard]] std::string take_errors(const functions& gl);

/// True where an extension is there. @pre current in this thread
[[nodiscard]] bool has_extension(const functions& gl, const char* name);

}  // namespace asperity::gl
