/* The page's program as bytes of ours. PLUMBLINE_VIEWER is the path of viewer/dist/viewer.js. */
    .section .rodata
    .global plumbline_viewer_begin
    .global plumbline_viewer_end
plumbline_viewer_begin:
    .incbin PLUMBLINE_VIEWER
plumbline_viewer_end:
    .byte 0
    .section .note.GNU-stack, "", %progbits
